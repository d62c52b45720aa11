(expect VP0129)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
o1 sub
G1 X20. F200.
o1 call
o1 endsub
o1 call
M2
