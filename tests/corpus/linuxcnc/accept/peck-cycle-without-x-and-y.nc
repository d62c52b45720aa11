(G83 where the tool stands, then holes by X or Y alone: the block has no words of the plane, yet its hole needs them)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G0 X20. Y20.
G98 G83 Z40. R52. Q3. F100.
X40.
Y40.
G80
G0 Z60.
M2
