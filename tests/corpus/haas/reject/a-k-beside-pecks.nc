%
O01109 (expect VP0217: K is the least peck here, and counts no holes)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G83 Z30. R55. I5. J1. K2. F150.
M30
%
