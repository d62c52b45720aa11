%
(Under G91 R counts from where the series began: 65 here, above it. The holes are left where they are on a machine)
(without errors: found by fuzzing, which saw L3 written out as three blocks)
G17 G21 G40 G49 G54 G80 G90
G0 X10 Y10 Z60
G99 G81 X20 Y20 Z30 R55 F100
G91 X15 Y0 Z-20 R5 L3
G90 G80
G0 X10 Y10 Z60
G98 G91 G81 X15 Y0 Z-20 R5 L2
X5
G90 G80
G0 X10 Y10 Z60
M2
%
