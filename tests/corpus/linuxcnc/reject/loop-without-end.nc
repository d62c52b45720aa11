(expect VP0130)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
o1 while [1]
G1 X20. F200.
o1 endwhile
M2
