%
O0001
(expect VP0217: L counts holes on Haas, and nothing on 0i)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G81 X20. Y20. Z50. R58. F200. L0
X30.
G80
M30
%
