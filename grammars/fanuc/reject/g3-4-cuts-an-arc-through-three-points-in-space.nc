%
O0001
(expect VP0208: cuts an arc through three points in space)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G3.4 X20. Y20. Z50.
M30
%
