//! What each rule of flow makes of a program.

mod common;

use common::{fanuc, linuxcnc, refused};

#[test]
fn smoke() {
    println!(
        "{}",
        fanuc(
            "%\nO0001\n#1=2.\nG0 X#1 Y[#1*2]\nWHILE[#1LT4]DO1\nN10 G1 X[#1/3] F100\n#1=#1+1\nEND1\nM98 P1000 L2\nM30\nO1000\nN10 X1.\nM99\n%\n"
        )
    );
    println!(
        "{}",
        linuxcnc(
            "o<a> sub\nG1 X#1 Y[#2+1]\no<a> endsub [3]\n#<x>=2 #3=5 G0 Y7\nG0 X#<x> Z#3\no1 repeat [2]\no<a> call [1] [2]\no1 endrepeat\no2 if [#<_value> GT 2]\nG0 Z#<_value>\no2 else\nG0 Z0\no2 endif\nM2\n"
        )
    );
    let _ = refused;
}
