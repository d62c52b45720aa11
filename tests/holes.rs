//! Holes on a machine that stands sideways elsewhere when an axis turns: where they begin, and where they are left.

use crate::common::{Place as Folder, messages, run};

const START: &str = "--start-at=20,20,400";
const HEAD: &str = "G21 G17 G40 G49 G80 G90 G94 G54\nG0 X10. Y10.\nG43 H1 Z80.\nS900 M3\n";

struct Place(Folder);

impl Place {
    /// A machine with tables for each direction. Z leans so much that holes are written as moves where `lean_urad` is large.
    fn new(lean_urad: f64) -> Self {
        let place = Self(Folder::new());
        let table = |axis: &str, low: &str, high: &str| {
            let names = ["EX", "EY", "EZ"].map(|e| format!("{e}{axis}_um")).join(",");
            let angles = ["EA", "EB", "EC"].map(|e| format!("{e}{axis}_urad")).join(",");
            format!("position_mm,{names},{angles}\n-100,{low}\n600,{high}\n")
        };
        place.0.write("x.csv", &table("X", "0,0,0,0,0,0", "0,0,0,30,-20,0"));
        place.0.write("x_negative.csv", &table("X", "4,0,0,0,0,0", "4,0,0,30,-20,0"));
        place.0.write("y.csv", &table("Y", "0,0,0,0,0,0", "0,0,0,20,0,0"));
        place.0.write("y_negative.csv", &table("Y", "0,8,0,0,0,0", "0,8,0,20,0,0"));
        place.0.write("z.csv", &table("Z", "0,0,0,0,0,0", "30,20,20,80,40,0"));
        place.0.write("z_negative.csv", &table("Z", "0,2.6,2.4,0,0,0", "30,22.6,22.4,80,40,0"));
        let axes = ["X", "Y", "Z"].map(|name| {
            let file = name.to_lowercase();
            format!(
                "axis.{name} = {{ travel_mm = [-100, 600], resolution_mm = 0.001, errors = \"{file}.csv\", \
                 errors_negative = \"{file}_negative.csv\" }}\n"
            )
        });
        place.0.write(
            "machine.toml",
            &format!(
                "format = 1\nname = \"holes\"\ncontrol = \"fanuc\"\nchain = \"[w Y b X Z t]\"\n{}\
                 squareness = {{ EB0Z_urad = {lean_urad} }}\nwork_offsets_mm = {{ G54 = [95, 88, 60] }}\n\
                 tool = {{ lengths_mm = {{ H1 = 80.0 }} }}\n",
                axes.concat()
            ),
        );
        place
    }

    fn path(&self, name: &str) -> String {
        self.0.0.path().join(name).to_str().expect("a plain path").to_owned()
    }

    /// What is made of a program, which `check` must pass.
    fn corrected(&self, program: &str) -> String {
        self.0.write("in.nc", program);
        let [from, to, machine] = ["in.nc", "out.nc", "machine.toml"].map(|name| self.path(name));
        let ran = run(&[&from, "-m", &machine, START, "-o", &to]);
        assert!(ran.status.success(), "{}", messages(&ran));
        let check = run(&["check", &from, &to, "-m", &machine, START]);
        assert!(check.status.success(), "{}", String::from_utf8_lossy(&check.stdout));
        std::fs::read_to_string(&to).expect("written")
    }
}

#[test]
fn a_hole_begins_beside_its_line_until_play_is_taken_up() {
    // Each peck of the cycle begins upwards of its play: 2.6 um beside the line, and level with no place of it.
    let drilled = format!(
        "{HEAD}X40. Y39. Z58.\nG99 G73 X46.8 Y3.7 Z-11.5 R3.5 Q7.2 F406.\nX29.2\nG80\nG0 Z50.\nM30\n"
    );
    for lean_urad in [0.0, 250.0] {
        let made = Place::new(lean_urad).corrected(&drilled);
        assert_eq!(made.contains("G73"), lean_urad == 0.0, "{made}");
    }
}

#[test]
fn a_hole_written_as_moves_is_left_on_the_side_on_which_the_axis_leaves_it() {
    // Z comes to 18 upwards before the hole and behind it: one place, one word.
    let drilled = format!(
        "{HEAD}X46.8 Y3.7 Z12.\nZ18.\nG98 G82 X46.8 Y3.7 Z-11.5 R2.2 P200 F406.\nG80\nG0 Z50.\nM30\n"
    );
    let made = Place::new(250.0).corrected(&drilled);
    let heights: Vec<&str> = made
        .lines()
        .filter_map(|line| {
            line.split_whitespace().find(|word| word.starts_with("Z17.") || word.starts_with("Z18."))
        })
        .collect();
    let [up, .., out] = heights.as_slice() else { panic!("{made}") };
    assert_eq!(up, out, "{made}");
}

/// P that a cycle written as moves has said holds for the cycle behind it, which stays one.
#[test]
fn words_of_a_cycle_that_is_written_as_moves_are_not_lost() {
    let place = Folder::new();
    let text = "G17 G21 G40 G54 G90\nG0 X10. Y10. Z60.\nG99 G89 X20. Y20. Z0. R55. F100. P500\n\
                G86 X40.\nX50.\nG80\nM30\n";
    let options = ["-m", "tests/profiles/stan_s500_square_1100.toml", "-d", "fanuc", "--zero", "true"];
    let (written, _) = place.corrected(text, &options);
    let says = |line: &&str| line.starts_with("G86") && line.contains(" P500");
    assert!(written.contains("G4 P500") && written.lines().filter(says).count() == 1, "{written}");
    let said = place.check(text, &written, &options).to_string();
    assert!(!said.contains("is in force"), "{written}\n{said}");
}

/// The same where nothing of the cycle behind has to be corrected: the machine leans up to X100 alone.
#[test]
fn words_of_a_cycle_are_not_lost_to_one_that_stays_as_it_is() {
    let place = Folder::new();
    place.write("x.csv", "position_mm,EBX_urad\n0,400\n100,400\n110,0\n400,0\n");
    let head = "format = 1\nname = \"leaning\"\ncontrol = \"fanuc\"\nchain = \"[w X Y b Z t]\"\n";
    let axis = |letter: &str| format!("[axis.{letter}]\ntravel_mm = [0, 400]\nresolution_mm = 0.001\n");
    let axes = axis("X") + "errors = \"x.csv\"\n" + &axis("Y") + &axis("Z");
    let machine = place.write("m.toml", &format!("{head}{axes}[work_offsets_mm]\nG54 = [0, 0, 0]\n"));
    let text = "G21 G90 G17 G54\nG0 X50. Y50. Z300.\nG89 Z100. R250. P500 F100\nX200.\n\
                G86 X300. Z100. R250.\nG80\nM30\n";
    let options = ["-m", &machine, "--zero", "true"];
    let (written, _) = place.corrected(text, &options);
    assert!(written.contains("\nG86 X300. Z100. R250. P500\n"), "{written}");
    assert_eq!(place.check(text, &written, &options)["passed"], true, "{written}");
}

/// LinuxCNC crosses to the next hole at another height where R lies a micrometre above the level of the series' start.
#[test]
fn a_series_that_begins_at_its_r_begins_there_in_the_output() {
    let place = Folder::new();
    place.write("x.csv", "position_mm,EZX_um\n-100,-10\n600,4\n");
    let axes = ["Y", "Z"].map(|name| format!("axis.{name} = {{ travel_mm = [-100, 600] }}\n")).concat();
    let machine = place.write(
        "machine.toml",
        &format!(
            "format = 1\nname = \"holes\"\ncontrol = {{ dialect = \"linuxcnc\", blending = {{ mode = \"exact-stop\" }} }}\n\
             chain = \"[w X Y b Z t]\"\naxis.X = {{ errors = \"x.csv\" }}\n{axes}\
             work_offsets_mm = {{ G54 = {{ at = [100, 100, 100], zero = \"true\" }} }}\n"
        ),
    );
    let program = "G21 G17 G90 G94 G40 G49 G80 G54 G99\nG0 X0 Y0 Z23.07\nG81 X40 Y20 Z-5 R38.8 F200\n\
                   X-34 Y-16 R23.07\nG80\nG0 Z60\nM2\n";
    let (out, said) = place.corrected(program, &["-m", &machine]);
    let word = |line: usize, letter: char| {
        let line = out.lines().nth(line).expect("as many lines");
        line.split(' ').find(|word| word.starts_with(letter)).expect("the word")[1..].to_owned()
    };
    assert_eq!(word(4, 'R'), word(2, 'Z'), "{out}\n{said}");
    assert_ne!(word(3, 'R'), "38.8", "{out}");
}
