(G74 and G84 belong to the spindle: hole by hole, never written as moves)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
M4 S500
G98 G74 X20. Y20. Z40. R52. F500.
X40.
G80
M3 S500
G84 X20. Y40. Z40. R52. F500.
X40.
G80
G0 Z60.
M2
