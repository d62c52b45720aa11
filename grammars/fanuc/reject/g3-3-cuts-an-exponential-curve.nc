%
O0001
(expect VP0208: cuts an exponential curve)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G3.3 X20. Y20. I30. J10. R5. F200.
M30
%
