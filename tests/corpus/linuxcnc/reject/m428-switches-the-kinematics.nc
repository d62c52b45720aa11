%
(expect VP0208: switches the kinematics where the machine has several)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
M428
X20.
M30
%
