%
O0001
(expect VP0208: tilts the working plane)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G68.4 X0 Y0 Z0 I0 J30. K0
M30
%
