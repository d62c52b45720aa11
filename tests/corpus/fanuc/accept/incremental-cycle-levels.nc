%
O0001
(under G91 R counts from the tool and Z from R)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G91 G99 G81 X5. Y5. R-8. Z-12. F100.
X5.
G90 G80
M30
%
