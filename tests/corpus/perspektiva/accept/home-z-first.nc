%CORPUS
(G91 G28 Z0 in every post: Z is unknown until an absolute rapid names it)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
X20.
G91 G28 Z0.
G90
G0 X30. Y30.
G0 Z60.
G1 Z50.
M30
%
