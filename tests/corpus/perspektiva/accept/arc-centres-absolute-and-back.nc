%CORPUS
(G90.1 measures I and J from the program's zero, G91.1 from the start; senders that know one of the two drew circles of the wrong size)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
G90.1
G2 X30. Y10. I20. J10.
G91.1
G3 X50. Y10. I10. J0
G0 Z60.
M30
%
