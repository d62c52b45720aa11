//! What files of controls say of a machine, and what they leave open.

use control_files::Machine;

/// An inch machine: its limits are inches; what turns is named, where it stands is not.
#[test]
fn an_ini_file_gives_name_control_and_travels() {
    let text = "[EMC]\nMACHINE = Mill 5\n[KINS]\nKINEMATICS = trivkins coordinates=xyza\n\
        [TRAJ]\nCOORDINATES = X Y Z A\nLINEAR_UNITS = inch\n\
        [AXIS_X]\nMIN_LIMIT = -10\nMAX_LIMIT = 10 # soft\nMAX_LIMIT = 11\n[AXIS_Z]\nMAX_LIMIT = 4\n[JOINT_1]\nMIN_LIMIT = -3\n";
    let machine = Machine::read("m.ini", text.as_bytes(), None).expect("a machine");
    let expected = Machine {
        name: Some("Mill 5".to_owned()),
        control: Some("linuxcnc"),
        travels_mm: [Some([-254.0, 254.0]), None, None],
        rotary: vec!['A'],
    };
    assert_eq!(machine, expected);
}

/// A main spindle is called C and turns to no position; limits stand as constraints or as a specification.
#[test]
fn a_probe_gives_name_and_axes() {
    let text = r#"<?xml version="1.0" encoding="UTF-8"?>
<MTConnectDevices xmlns="urn:mtconnect.org:MTConnectDevices:1.7"><Header version="1.7"/><Devices>
<Device name="VMC" id="d"><Components><Axes id="a"><Components>
  <Linear name="X1" nativeName="X" id="x"><DataItems>
    <DataItem type="POSITION" coordinateSystem="WORK" units="MILLIMETER"><Constraints><Minimum>1</Minimum><Maximum>2</Maximum></Constraints></DataItem>
    <DataItem type="POSITION" coordinateSystem="MACHINE" units="MILLIMETER"><Constraints><Minimum>-762</Minimum><Maximum>0.0</Maximum></Constraints></DataItem>
  </DataItems></Linear>
  <Linear name="Y" id="y"><Configuration><Specifications>
    <Specification type="POSITION" units="MILLIMETER"><Maximum>406</Maximum><Minimum>0</Minimum></Specification>
  </Specifications></Configuration></Linear>
  <Linear name="Z" id="z"/>
  <Rotary name="C" id="s"><DataItems><DataItem type="ROTARY_MODE"><Constraints><Value>SPINDLE</Value></Constraints></DataItem>
    <DataItem type="ANGLE"/></DataItems></Rotary>
  <Rotary name="B" id="b"><DataItems><DataItem type="ANGLE" units="DEGREE"/></DataItems></Rotary>
</Components></Axes></Components></Device></Devices></MTConnectDevices>"#;
    let machine = Machine::read("probe.xml", text.as_bytes(), None).expect("a machine");
    let expected = Machine {
        name: Some("VMC".to_owned()),
        control: None,
        travels_mm: [Some([-762.0, 0.0]), Some([0.0, 406.0]), None],
        rotary: vec!['B'],
    };
    assert_eq!(machine, expected);
}

proptest::proptest! {
    /// Any bytes are read or refused.
    #[test]
    fn any_bytes_end(bytes in proptest::collection::vec(proptest::num::u8::ANY, 0..400), xml in proptest::bool::ANY) {
        let text = if xml { [b"<MTConnectDevices>", &bytes[..]].concat() } else { [b"[TRAJ]\nLINEAR_UNITS=mm\n", &bytes[..]].concat() };
        let _ = Machine::read("m", &text, None);
    }
}

#[test]
fn axes_are_numbered_in_ini_files_up_to_2_7() {
    // As makerspaces have them still; 3 is A, whatever the coordinates.
    let text = "[TRAJ]\nLINEAR_UNITS = mm\nCOORDINATES = X Y Z A\n[AXIS_0]\nMIN_LIMIT = -10\nMAX_LIMIT = 130\n\
        [AXIS_2]\nMIN_LIMIT = -65\nMAX_LIMIT = 10\n[AXIS_3]\nMIN_LIMIT = -360\nMAX_LIMIT = 360\n";
    let machine = Machine::read("cnc.ini", text.as_bytes(), None).expect("a machine");
    assert_eq!(machine.travels_mm, [Some([-10.0, 130.0]), None, Some([-65.0, 10.0])]);
    assert_eq!(machine.rotary, ['A']);
    // A letter counts more than a number.
    let both = format!("{text}[AXIS_X]\nMIN_LIMIT = 0\nMAX_LIMIT = 5\n");
    let machine = Machine::read("cnc.ini", both.as_bytes(), None).expect("a machine");
    assert_eq!(machine.travels_mm[0], Some([0.0, 5.0]));
}
