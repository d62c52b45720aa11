%CORPUS
(expect VP0103: GOST 20999-83 forbids percent signs and colons in comments; an unclosed one is refused, not read on)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 X20. F200. (50%
G1 X40.
M30
%
