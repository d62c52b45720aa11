%TOOL G71 *
N10 ;expect VP0208: the profile may say another length *
N20 G99 T1 L+0 R+3 *
N30 T1 G17 S2000 *
N40 G00 G40 G90 X+0 Y+0 Z+50 *
N50 M30 *
N99999999 %TOOL G71 *
