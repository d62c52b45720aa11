%
O0001
(expect VP0208: positions with an overrun that a parameter sets)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G60 X20.
M30
%
