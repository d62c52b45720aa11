%
O0001
(expect VP0208: measures a tool and changes its length while the program runs)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G37 Z20. H1
M30
%
