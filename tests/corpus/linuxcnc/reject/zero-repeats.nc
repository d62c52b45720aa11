%
(expect VP0217: L0 is an error of the interpreter)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G81 X20. Y20. Z50. R58. F200. L0
M2
%
