%
O0001
(expect VP0514: nobody has said where Z is in G55)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G55
G1 X400. Y300. F200.
M30
%
