%
O0001
(expect VP0208: shifts the work offset with the rotary axes)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G254
M30
%
