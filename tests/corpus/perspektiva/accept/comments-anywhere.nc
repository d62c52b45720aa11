%CORPUS
(comments before, between and after words)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
(a) G1 (b) Z50. (c) F200. (d)
X20. (X30. is not a word)
M30
%
