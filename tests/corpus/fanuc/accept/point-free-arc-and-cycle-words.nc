%
O0001
(I, R, Q and P without a point count as X does, and P of a dwell milliseconds, F not at all: a reader with one rule for all of them is off by 1000)
G17 G21 G40 G49 G54 G80 G90
G0 X10000 Y10000 Z60000
G1 Z50000 F200
G2 X30000 I10000 J0
G3 X10000 R10000
G4 P500
G0 Z60000
G98 G83 X20000 Y20000 Z40000 R52000 Q3000 F100
X40000
G80
G0 Z60000
M30
%
