(a block without motion in the plane under compensation: look-ahead counts blocks, so their number must not change)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
G42 D1 X20. Y10.
X24. Y14.
Z49.
X28. Y18.
G40 X20. Y22.
G0 Z60.
M2
