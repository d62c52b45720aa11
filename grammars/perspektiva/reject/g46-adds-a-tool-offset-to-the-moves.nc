%CORPUS
(expect VP0208: adds a tool offset to the moves, GOST 20999-83, G45 to G52)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G46 X20. D1 F200.
M30
%
