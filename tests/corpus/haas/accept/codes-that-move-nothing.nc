%
O01104 (relays, conveyor, coolant, air and messages)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60. M31
M12
M21
M22
M23
M24
M25
M26
M27
M28
M34
M35
M59
M69
M83
M84
M88
M89
M33
G102 X1. Y2. (a line to the printer)
G269
M777 (the builder's)
G1 Z50. F200.
X90.
G0 Z60.
M30
%
