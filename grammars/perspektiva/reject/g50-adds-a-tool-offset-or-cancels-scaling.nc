%CORPUS
(expect VP0208: adds a tool offset in GOST 20999-83, or cancels scaling)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G50
M30
%
