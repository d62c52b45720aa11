%
O0001
(expect VP0217: K is the smallest peck on Haas, a count of holes on Fanuc)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G83 X20. Y20. Z50. R58. I2. J0.5 K1 F200.
G80
M30
%
