G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
#1=0
o1 while [1]
#1=[#1+1]
o2 if [#1 GT 4]
o1 break
o2 elseif [#1 EQ 2]
o1 continue
o2 else
G1 X[20+#1] F200.
o2 endif
o1 endwhile
M2
