%
O0001
(expect VP0514: some controls end the length with G53, and Z is where no word of the frame says)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10.
G43 H1 Z60.
G0 G53 Z200.
G1 X400. Y300. F200.
M30
%
