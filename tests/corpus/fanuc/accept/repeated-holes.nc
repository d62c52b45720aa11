%
O0001
(G91 K5: five holes, each with its own correction)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G99 G81 X20. Y20. Z40. R52. F100.
G91 X10. K5
G90 G80
M30
%
