%
O0001
(expect VP0208: drills a line of holes by a cycle of the control)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G35 X50. Y50. I20. J0 L6
M30
%
