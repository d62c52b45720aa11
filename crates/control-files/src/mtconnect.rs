//! The answer of an MTConnect agent to `probe`: which axes a machine has (MTConnect part 2, ANSI/MTC1.4 and later).

use diagnostic::{Text, both};
use measurement_files::Refusal;
use roxmltree::{Document, Node};

use crate::machine::Machine;
use crate::refusals::{BEYOND, File, UNREADABLE, refuse_at, refuse_whole};

/// The machine of a `probe`.
pub(crate) fn machine(file: File<'_>, device: Option<&str>) -> Result<Machine, Box<Refusal>> {
    let document = Document::parse(file.1).map_err(|error| {
        let position = error.pos();
        let message = both!("line {}: {error}", "строка {}: {error}", position.row);
        let help = both!("save the agent's answer as it came", "сохраните ответ агента как есть");
        refuse_whole(file, UNREADABLE, message, help)
    })?;
    let root = document.root_element();
    if root.tag_name().name() != "MTConnectDevices" {
        let name = root.tag_name().name();
        let message = both!("`{name}` describes no machine", "`{name}` не описывает станок");
        let label = both!("expected MTConnectDevices", "ожидалось MTConnectDevices");
        let help = both!(
            "ask the agent for `probe`, and save that: http://AGENT:5000/probe",
            "запросите у агента `probe` и сохраните ответ: http://AGENT:5000/probe"
        );
        return Err(refuse_at(file, name_of(&root), UNREADABLE, message, label, help));
    }
    let devices: Vec<Node<'_, '_>> =
        elements(root, "Device").filter(|d| elements(*d, "Linear").next().is_some()).collect();
    let named =
        |node: &Node<'_, '_>| node.attribute("name").or(node.attribute("id")).unwrap_or_default().to_owned();
    let all: Vec<String> = devices.iter().map(named).collect();
    let wanted: Vec<Node<'_, '_>> =
        devices.into_iter().filter(|node| device.is_none_or(|device| named(node) == device)).collect();
    let [device] = wanted[..] else {
        let list = all.join(", ");
        let (message, help) = match (wanted.len(), device) {
            (0, Some(device)) if !all.is_empty() => (
                both!("there is no device `{device}` with axes", "устройства `{device}` с осями нет"),
                both!("one of: {list}", "одно из: {list}"),
            ),
            (0, _) => (
                both!(
                    "no device of this file has linear axes",
                    "ни у одного устройства в файле нет линейных осей"
                ),
                both!("give the answer of the machine's own agent", "дайте ответ агента этого станка"),
            ),
            _ => (
                both!("the file describes several machines: {list}", "в файле несколько станков: {list}"),
                both!("say which: `--device NAME`", "скажите, который: `--device ИМЯ`"),
            ),
        };
        return Err(refuse_whole(file, BEYOND, message, help));
    };
    let mut machine = Machine { name: Some(named(&device)), ..Machine::default() };
    for (travel, letter) in machine.travels_mm.iter_mut().zip(['X', 'Y', 'Z']) {
        let called = |node: &Node<'_, '_>| is_called(node, letter);
        let axes: Vec<Node<'_, '_>> = elements(device, "Linear").filter(called).collect();
        if let [_, second, ..] = axes[..] {
            let message = both!("two axes are called {letter}", "две оси названы {letter}");
            let label = both!("the second of them", "вторая из них");
            let help = both!(
                "which one carries the tool is not said: leave `--from` out and give `--travel`",
                "какая из них несёт инструмент, не сказано: уберите `--from` и задайте `--travel`"
            );
            return Err(refuse_at(file, name_of(&second), BEYOND, message, label, help));
        }
        if let Some(axis) = axes.first() {
            *travel = limits_mm(file, axis, letter)?;
        }
    }
    let turning = elements(device, "Rotary").filter(positions);
    machine.rotary =
        turning.filter_map(|axis| ['A', 'B', 'C'].into_iter().find(|l| is_called(&axis, *l))).collect();
    machine.rotary.sort_unstable();
    machine.rotary.dedup();
    Ok(machine)
}

/// Elements of that name below a node.
fn elements<'a, 'd>(node: Node<'a, 'd>, name: &'static str) -> impl Iterator<Item = Node<'a, 'd>> {
    node.descendants().filter(move |below| below.tag_name().name() == name)
}

/// The place of an element's name.
fn name_of(node: &Node<'_, '_>) -> std::ops::Range<usize> {
    let start = node.range().start + 1;
    start..start + node.tag_name().name().len()
}

fn is_called(node: &Node<'_, '_>, letter: char) -> bool {
    let is = |name: &str| name.chars().eq([letter]);
    node.attribute("name").is_some_and(is) || node.attribute("nativeName").is_some_and(is)
}

/// True for an axis that turns to an angle: a main spindle is called C, too.
fn positions(axis: &Node<'_, '_>) -> bool {
    let items = || elements(*axis, "DataItem");
    let is = |item: &Node<'_, '_>, kind: &str| item.attribute("type") == Some(kind);
    let modes: Vec<&str> = items()
        .filter(|item| is(item, "ROTARY_MODE"))
        .flat_map(|item| elements(item, "Value").filter_map(|value| value.text()))
        .map(str::trim)
        .collect();
    let is_spindle = !modes.is_empty() && modes.iter().all(|mode| *mode == "SPINDLE");
    !is_spindle && items().any(|item| is(&item, "ANGLE") || is(&item, "ROTARY_MODE"))
}

/// Where a linear axis ends in machine coordinates, mm: constraints of its position, or a specification of it.
fn limits_mm(file: File<'_>, axis: &Node<'_, '_>, letter: char) -> Result<Option<[f64; 2]>, Box<Refusal>> {
    let of_position = |node: &Node<'_, '_>| {
        node.attribute("type") == Some("POSITION") && node.attribute("coordinateSystem") != Some("WORK")
    };
    let told = elements(*axis, "DataItem").chain(elements(*axis, "Specification")).filter(of_position);
    let mut found: Option<[f64; 2]> = None;
    for node in told {
        let limit = |name: &'static str| {
            let Some(element) = elements(node, name).next() else { return Ok(None) };
            let value = element.text().unwrap_or_default().trim();
            let message = || both!("`{value}` is no limit of {letter}", "`{value}` — не предел оси {letter}");
            let number = value.parse::<f64>().ok().filter(|number| number.is_finite());
            number.map(Some).ok_or_else(|| refused(file, &element, message()))
        };
        let Some((low, high)) = limit("Minimum")?.zip(limit("Maximum")?) else { continue };
        if let Some(unit) = node.attribute("units").filter(|unit| *unit != "MILLIMETER") {
            let message =
                both!("the position of {letter} is in `{unit}`", "положение {letter} задано в `{unit}`");
            return Err(refused(file, &node, message));
        }
        if found.is_some_and(|found| found != [low, high]) {
            let message = both!(
                "{letter} has limits twice, and they differ",
                "пределы {letter} заданы дважды и по-разному"
            );
            return Err(refused(file, &node, message));
        }
        found = Some([low, high]);
    }
    Ok(found)
}

fn refused(file: File<'_>, node: &Node<'_, '_>, message: Text) -> Box<Refusal> {
    let label =
        both!("expected one pair of numbers, in MILLIMETER", "ожидалась одна пара чисел в MILLIMETER");
    let help = both!("leave `--from` out and give `--travel`", "уберите `--from` и задайте `--travel`");
    refuse_at(file, name_of(node), UNREADABLE, message, label, help)
}
