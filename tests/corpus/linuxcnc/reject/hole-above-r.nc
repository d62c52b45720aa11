%
(expect VP0217: under G91 the depth of 30 counts from R, upwards; the interpreter stops)
G17 G21 G40 G49 G54 G80 G90
G0 X10 Y10 Z60
F150
G99 G81 X20 Y20 Z30 R55
G91 X15
G90 G80
M2
%
