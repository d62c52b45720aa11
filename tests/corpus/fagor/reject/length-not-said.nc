; expect VP0215: the 8065 moves by the length of T1 here, the 8055 without it
N10 G17 G71 G90 G54
N20 T1 M06
N30 G00 X0 Y0
N40 Z50
N50 M30
