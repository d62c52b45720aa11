%
O0001
(expect VP0208: mills a circular pocket by a cycle of the control)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G12 I10. D1 F200.
M30
%
