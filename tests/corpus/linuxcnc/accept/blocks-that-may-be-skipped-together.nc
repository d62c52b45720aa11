(Sections under block delete go on from block to block: moves, a motion code that the section changes, an arc, a)
(setting that it takes back, a drilling cycle of its own; behind each all axes are named)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
/G1 Z50. F200.
/X30.
/Y30.
/G2 X40. Y40. I10.
/G0 Z60.
G0 X10. Y10. Z60.
G1 Z50. F200.
X20.
/G91
/X5.
(a remark ends nothing)
/Y5.
/G90
G0 X20. Y20. Z50.
G0 Z60.
/G99 G81 X60. Y60. Z45. R52. F100.
/X80.
/G80
/G0 X300. Y200. Z60.
/G1 X310. F150.
G0 X10. Y10. Z60.
G1 X40. F200.
M30
