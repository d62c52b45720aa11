%
%
O1
(expect VP0228: the second percent sign closes what the first opens)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 X20. F200.
M30
