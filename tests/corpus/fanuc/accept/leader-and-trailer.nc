PART 12 REV A
%
O0001
(text before the first and after the last percent sign is not executed)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
X20. Y20.
G0 Z60.
M30
%
X99. is no block here
