%
O01103 (L counts holes; L0 only says what the next blocks do)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G99 G81 Z30. R55. F150. L0
X20. Y20.
G91 X15. L4
G90 G80
G0 X0. Y0. Z60.
M30
%
