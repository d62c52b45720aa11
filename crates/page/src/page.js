// The page: files, a form made of the command's own description, results. It computes nothing: the worker runs the command.

const by = (id) => document.getElementById(id);
const part = (tag, with_ = {}, ...children) => {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(with_)) {
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else if (value === true) made.setAttribute(name, "");
    else if (value !== false && value !== undefined && value !== null) made.setAttribute(name, value);
  }
  made.append(...children.filter((child) => child !== null && child !== undefined));
  return made;
};

/** What the page offers: commands, the options that stand at the top, what each run writes; `isAlone`: it makes profiles
 * and needs none. */
const JOBS = [
  {
    id: "correct",
    path: ["correct"],
    top: ["machine", "dialect", "tolerance", "path-control"],
    made: ({ stem, ending }) => ({ output: `${stem}_corrected${ending}`, summary: `${stem}_summary.json` }),
  },
  {
    id: "check",
    path: ["check"],
    top: ["machine", "dialect", "tolerance"],
    made: ({ stem }) => ({ html: `${stem}_check.html`, viewer: `${stem}_path.html` }),
  },
  {
    id: "diagnose",
    path: ["diagnose"],
    top: ["machine", "holdout"],
    made: ({ stem }) => ({
      html: `${stem}_diagnosis.html`,
      json: `${stem}_diagnosis.json`,
      "write-profile": `${stem}_profile.toml`,
    }),
  },
  {
    id: "map",
    path: ["map"],
    top: ["machine", "part-box", "clamp"],
    made: () => ({ html: "map.html", viewer: "map_viewer.html", json: "map.json" }),
  },
  {
    id: "calibrate",
    path: ["calibrate"],
    top: ["machine", "name", "chain"],
    isAlone: true,
    made: () => ({ output: "calibrated.toml", html: "calibration.html", json: "calibration.json" }),
  },
  {
    id: "profile_new",
    path: ["profile", "new"],
    top: ["name", "control", "chain", "travel", "table"],
    made: () => ({ output: "machine.toml" }),
  },
  { id: "budget", path: ["budget"], top: ["machine", "target"], made: () => ({ json: "budget.json" }) },
  {
    id: "restart",
    path: ["restart"],
    top: ["machine", "line"],
    made: ({ stem, ending }) => ({ output: `${stem}_restart${ending}` }),
  },
];
/** Options that a page has no use for. */
const UNASKED = ["quiet", "verbose", "color", "lang", "help", "version", "progress", "json"];
/** Programs up to this size are compared and drawn behind the correction without being asked, bytes. */
const DRAWN_BYTES = 5e6;
/** Of messages and answers the page shows so much, letters: what is longer can be downloaded. */
const SHOWN = 60000;
/** And so many messages as questions of their own. */
const CARDS = 20;

/** Files to begin with for those who type their measurements: names and first lines. */
const PATTERNS = {
  interferometer: ["interferometer_x.csv", "position_mm,EXX_um\n0,0.0\n100,1.2\n200,2.9\n"],
  squareness: ["points.csv", "run,x_mm,y_mm,z_mm,dy_um\nr1,0,0,0,0\nr1,300,0,0,6.0\n"],
  ballbar: [
    "ballbar.csv",
    "run,x_mm,y_mm,z_mm,bx_mm,by_mm,bz_mm,length_mm\nr1,100,0,0,0,0,0,100.0012\nr1,0,100,0,0,0,0,99.9987\n",
  ],
};

/** What the command looks for beside a program. */
const SETTINGS = "vpost.toml";

let language = navigator.language.toLowerCase().startsWith("ru") ? "ru" : "en";
let job = JOBS[0];
/** @type {Map<string, Blob>} dropped and made, by path */
const files = new Map();
/** Those that runs made, each with the job and the file that it was made of. */
const made = new Map();
/** What was typed, by option or by command and place: kept from job to job. */
const typed = new Map();
/** The command line as data, by language. */
const described = new Map();
let dialects = [];

/** A run is under way: there is one worker. */
let isBusy = false;

const words = () => WORDS[language];

// The worker

let worker, waiting, address;

function start() {
  address ??= URL.createObjectURL(new Blob([by("beside").textContent], { type: "text/javascript" }));
  worker = new Worker(address);
  worker.postMessage({ kind: "start", text: by("command").textContent });
  worker.onmessage = ({ data }) => {
    if (data.kind === "progress") waiting?.progress?.(data.percent);
    else if (data.kind === "done") settle("resolve", data.result);
    else settle("reject", Object.assign(new Error(data.text), { unread: data.unread }));
  };
  worker.onerror = (event) => {
    event.preventDefault();
    settle("reject", new Error(event.message));
  };
}

function settle(how, value) {
  const asked = waiting;
  waiting = undefined;
  asked?.[how](value);
}

let queue = Promise.resolve();

/** One task of the worker after the other. */
function ask(task, progress) {
  const next = queue.then(
    () =>
      new Promise((resolve, reject) => {
        waiting = { resolve, reject, progress };
        worker.postMessage(task);
      }),
  );
  queue = next.catch(() => {});
  return next;
}

function stop() {
  worker.terminate();
  start();
  settle("reject", new Error("stopped"));
}

/** Runs the command on all files but some, in the page's language as a shell's locale gives it. */
const run = (args, progress, without = []) => {
  const given = [...files].filter(([path]) => !without.includes(path)).map(([path, blob]) => ({ path, blob }));
  return ask({ kind: "run", args, language, files: given }, progress);
};

// Files

function kindOf(path) {
  const ending = path.split(".").at(-1).toLowerCase();
  if (ending === "toml") return path.split("/").at(-1).toLowerCase() === SETTINGS ? "other" : "profile";
  if (["csv", "json", "xml", "rtl", "pos", "txt", "ini", "tbl", "var", "htm", "html", "pdf"].includes(ending)) {
    return ["csv", "txt", "rtl", "pos"].includes(ending) ? "measurement" : "other";
  }
  return "program";
}

/** Puts a file into the list; one that was there goes, which is said. */
function put(path, blob) {
  if (files.has(path)) tell(words().replaced(path));
  files.set(path, blob);
  made.delete(path);
}

async function take(path, blob) {
  if (!/\.zip$/i.test(path)) return put(path, blob);
  try {
    for (const inside of await ask({ kind: "unzip", blob })) put(inside.path, inside.blob);
  } catch {
    tell(words().zip(path));
  }
}

async function takeAll(given) {
  tell("");
  for (const file of given) await take(file.webkitRelativePath || file.name, file);
  show();
}

/** Files of what was dropped, folders walked through. */
async function dropped(transfer) {
  // Taken at once: behind the event nothing is left of it. A page from the disk may read files, but none of an entry.
  const given = [...transfer.items]
    .filter((item) => item.kind === "file")
    .map((item) => ({ entry: item.webkitGetAsEntry?.(), file: item.getAsFile() }));
  if (!given.length) return takeAll(transfer.files);
  tell("");
  const walk = async (entry, above) => {
    if (entry.isFile) {
      await take(above + entry.name, await new Promise((done, failed) => entry.file(done, failed)));
      return;
    }
    const reader = entry.createReader();
    for (;;) {
      const some = await new Promise((done, failed) => reader.readEntries(done, failed));
      if (!some.length) return;
      for (const inner of some) await walk(inner, `${above}${entry.name}/`);
    }
  };
  // A folder that is dropped alone is where its profile looks for tables from.
  for (const { entry, file } of given) {
    if (entry?.isDirectory) await walk(entry, "").catch(() => tell(words().noFolder(entry.name)));
    else if (file) await take(file.name, file);
  }
  show();
}

/** Says something of files, a line each; nothing clears it. */
function tell(text) {
  const said = by("list-said");
  said.textContent = text && said.textContent ? `${said.textContent} ${text}` : text;
  said.hidden = !text;
}

function size(bytes) {
  const [unit, divisor] = bytes < 1e3 ? ["B", 1] : bytes < 1e6 ? ["kB", 1e3] : ["MB", 1e6];
  return `${(bytes / divisor).toLocaleString(language, { maximumFractionDigits: 1 })} ${unit}`;
}

function list() {
  const said = words();
  const remove = (path) =>
    part(
      "button",
      {
        type: "button",
        "aria-label": `${said.remove}: ${path}`,
        onclick: () => {
          files.delete(path);
          for (const [key, value] of typed) if (value === path) typed.delete(key);
          show();
          by("list").focus();
        },
      },
      "×",
    );
  const row = (path) =>
    part(
      "tr",
      {},
      part("td", {}, path),
      part("td", {}, said[kindOf(path)]),
      part("td", { class: "n" }, size(files.get(path).size)),
      // What a run made stays at hand, whatever the next one says.
      part("td", {}, ...(made.has(path) ? [save(path, files.get(path))] : []), remove(path)),
    );
  const table = (some) =>
    part(
      "div",
      { class: "scroll" },
      part(
        "table",
        {},
        part(
          "thead",
          {},
          part(
            "tr",
            {},
            ...["name", "kind", "size"].map((word) => part("th", { scope: "col" }, said[word])),
            part("td"),
          ),
        ),
        part("tbody", {}, ...some.map(row)),
      ),
    );
  const all = [...files.keys()];
  const first = all.filter((path) => ["program", "profile"].includes(kindOf(path)));
  const others = all.filter((path) => !first.includes(path));
  const isOpen = by("list").querySelector("details")?.open ?? first.length === 0;
  by("list").replaceChildren(
    ...(all.length
      ? [
          ...(first.length ? [table(first)] : []),
          ...(others.length
            ? [part("details", { open: isOpen }, part("summary", {}, said.others(others.length)), table(others))]
            : []),
          part(
            "p",
            {},
            part(
              "button",
              {
                type: "button",
                onclick: () => {
                  files.clear();
                  typed.clear();
                  show();
                },
              },
              said.clear,
            ),
          ),
        ]
      : [part("p", { class: "muted" }, said.none)]),
  );
}

/** Files of a kind first, then the others. */
function paths(kind) {
  const all = [...files.keys()];
  return [...all.filter((path) => kindOf(path) === kind), ...all.filter((path) => kindOf(path) !== kind)];
}

// The form

/** What kind of file a value names; none where it names no file. */
function fileKind(argument) {
  const named = argument.value ?? "";
  if (named.startsWith("PROFILE") || named === "OLD.toml") return "profile";
  if (/\.nc/.test(named)) return "program";
  return /FILE|\.csv/.test(named) ? "measurement" : null;
}

/** The command of the form. */
function command() {
  let found = described.get(language)?.command;
  const path = [...job.path];
  if (job.id === "calibrate") path.push(typed.get("calibrate") ?? "interferometer");
  for (const name of path) found = found?.commands.find((inner) => inner.name === name);
  return found && { ...found, path };
}

/** What the form asks for of a command: what the page itself gives it is left out. */
function asks(found) {
  const given = job.made({ stem: "", ending: "" });
  return found.arguments.filter((argument) => !UNASKED.includes(argument.id) && !(argument.long in given));
}

const keyOf = (argument, found) => argument.long ?? `${found.path.join(" ")} ${argument.id}`;

function field(argument, found) {
  const said = words(),
    key = keyOf(argument, found),
    id = `field ${key}`.replaceAll(" ", "-");
  const value = typed.get(key) ?? chosen(argument, found).value ?? "";
  const keep = (event) => {
    typed.set(key, event.target.type === "checkbox" ? (event.target.checked ? "yes" : "") : event.target.value);
  };
  // A page has no standard input.
  const help = [
    (argument.help ?? "").replace(/; - .*$/, ""),
    argument.many && argument.value ? said.many : null,
    argument.required ? said.required : null,
  ]
    .filter(Boolean)
    .join(" · ");
  const label = part("label", { for: id }, help, argument.long ? part("code", {}, ` --${argument.long}`) : null);
  const common = { id, onchange: keep, oninput: keep };
  const select = (choices, empty) =>
    part(
      "select",
      common,
      part("option", { value: "" }, empty),
      ...choices.map((choice) => part("option", { value: choice, selected: choice === value }, choice)),
    );
  const kind = fileKind(argument);
  if (!argument.value) {
    return part("p", { class: "flag" }, part("input", { type: "checkbox", checked: value !== "", ...common }), label);
  }
  if (argument.long === "chain") return chains(argument, key);
  let input;
  if (argument.values.length) input = select(argument.values, argument.default ?? "–");
  else if (argument.value === "DIALECT") input = select(dialects, "–");
  else if (kind && !argument.many) input = select(paths(kind), said.choice);
  else if (argument.many) {
    input = part("textarea", {
      rows: Math.max(1, Math.min(6, value.split("\n").length)),
      placeholder: argument.value,
      ...common,
    });
    input.value = value;
  } else input = part("input", { type: "text", placeholder: argument.default ?? argument.value, value, ...common });
  return part("p", {}, label, input);
}

/** Chains by their pictures: from the workpiece to the tool, `b` the bed. */
function chains(argument, key) {
  const said = words();
  const choice = ([chain, name]) => {
    const id = `chain ${chain}`.replaceAll(" ", "-");
    return part(
      "label",
      { class: "chain", for: id },
      part("input", {
        type: "radio",
        name: "chain",
        id,
        value: chain,
        checked: typed.get(key) === chain,
        onchange: () => typed.set(key, chain),
      }),
      drawing(chain),
      part("span", {}, name),
      part("code", {}, chain),
    );
  };
  return part(
    "fieldset",
    {},
    part("legend", {}, said.chain, part("code", {}, " --chain")),
    part("div", { class: "chains" }, ...Object.entries(said.chains).map(choice)),
  );
}

function drawing(chain) {
  const shape = (tag, with_) => {
    const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [name, value] of Object.entries(with_)) made.setAttribute(name, value);
    return made;
  };
  const names = chain.replace(/[[\]]/g, "").split(" ");
  const drawn = shape("svg", {
    viewBox: `0 0 ${names.length * 30} 34`,
    width: names.length * 26,
    height: 30,
    "aria-hidden": "true",
  });
  drawn.append(shape("path", { d: `M15 17H${names.length * 30 - 15}`, class: "axis" }));
  for (const [at, name] of names.entries()) {
    const x = at * 30 + 15;
    if (name === "t") drawn.append(shape("path", { d: `M${x - 8} 7h16l-8 22z`, class: "frame" }));
    else if ("ABC".includes(name)) drawn.append(shape("circle", { cx: x, cy: 17, r: 12, class: "frame" }));
    else
      drawn.append(
        shape("rect", { x: x - 12, y: 5, width: 24, height: 24, class: name === "b" ? "frame bed" : "frame" }),
      );
    const letter = shape("text", { x, y: name === "t" ? 17 : 21, class: "c" });
    letter.textContent = { w: "▣", b: "▤", t: "" }[name] ?? name;
    drawn.append(letter);
  }
  return drawn;
}

function form() {
  const said = words(),
    found = command();
  if (!found) return;
  const asked = asks(found);
  const isTop = (argument) => !argument.long || argument.required || job.top.includes(argument.long);
  const groups = new Map();
  for (const argument of asked.filter((argument) => !isTop(argument))) {
    const heading = argument.heading ?? said.more;
    groups.set(heading, [...(groups.get(heading) ?? []), argument]);
  }
  const kinds =
    job.id === "calibrate"
      ? described.get(language).command.commands.find((inner) => inner.name === "calibrate").commands
      : [];
  const top = asked
    .filter(isTop)
    .sort((a, b) => (a.long ? 1 + job.top.indexOf(a.long) : 0) - (b.long ? 1 + job.top.indexOf(b.long) : 0));
  by("form").replaceChildren(
    part("p", { class: "muted" }, found.about ?? ""),
    ...(kinds.length
      ? [
          part(
            "p",
            {},
            part(
              "label",
              { for: "instrument" },
              described.get(language).command.commands.find((inner) => inner.name === "calibrate").about,
            ),
            part(
              "select",
              {
                id: "instrument",
                onchange: (event) => {
                  typed.set("calibrate", event.target.value);
                  form();
                  by("instrument").focus();
                },
              },
              ...kinds.map((kind) =>
                part("option", { value: kind.name, selected: kind.name === found.name }, `${kind.name}: ${kind.about}`),
              ),
            ),
          ),
        ]
      : []),
    ...top.map((argument) => field(argument, found)),
    ...[...groups].map(([heading, some]) =>
      part(
        "details",
        { open: some.some((argument) => typed.get(keyOf(argument, found))) },
        part("summary", {}, heading),
        ...some.map((argument) => field(argument, found)),
      ),
    ),
    part("p", {}, part("button", { type: "submit", id: "run", disabled: isBusy }, said.run)),
  );
}

/** What stands in a field: what was typed, else the files that it can mean, where only one way is possible. */
function chosen(argument, found) {
  const given = typed.get(keyOf(argument, found));
  const kind = fileKind(argument);
  const fit = paths(kind).filter((path) => kindOf(path) === kind);
  if (given === undefined && kind && argument.many && !argument.long) return { value: fit.join("\n") };
  if (given || !kind || argument.many) return { value: given ?? "" };
  if (argument.long && (argument.long !== "machine" || job.isAlone)) return { value: "" };
  // Settings that were dropped may name the profile: what the page chose would go before them without a word.
  if (argument.long && [...files.keys()].some((path) => path.split("/").at(-1) === SETTINGS)) return { value: "" };
  const isCorrected = (path) => /_corrected(_\d+)?(\.[^.]*)?$/.test(path);
  const able = fit.filter((path) => isCorrected(path) === /^OUT/.test(argument.value));
  if (able.length === 1) return { value: able[0] };
  if (able.length > 1) return { said: words().several(words()[kind], able.length) };
  return argument.required || argument.long === "machine" ? { said: words().missing(words()[kind]) } : { value: "" };
}

/** The call that the form means, or what is missing for it. */
function call() {
  const found = command();
  const options = [],
    places = [];
  let first = "";
  for (const argument of asks(found)) {
    const { value, said } = chosen(argument, found);
    if (said) return { said };
    const values =
      argument.many && argument.value
        ? value
            .split("\n")
            .map((line) => line.trim())
            .filter(Boolean)
        : [value].filter(Boolean);
    if (argument.long)
      options.push(...values.map((each) => (argument.value ? `--${argument.long}=${each}` : `--${argument.long}`)));
    else places.push(...values.map((each) => (each.startsWith("-") ? `./${each}` : each)));
    // Of `runs.csv=EXX:um` the file.
    if (!argument.long && !first) first = argument.many ? (values[0] ?? "").replace(/=.*$/, "") : (values[0] ?? "");
  }
  const of = `${job.id} ${first}`;
  const [stem, ending] = parted(first.split("/").at(-1) || "machine");
  const read = [...places, ...options.map((each) => each.replace(/^[^=]*=/, ""))];
  const outputs = Object.entries(job.made({ stem, ending }))
    .filter(([option]) => found.arguments.some((argument) => argument.long === option))
    .map(([option, path]) => [option, free(path, of, read)]);
  return {
    args: [...found.path, ...places, ...options, ...outputs.map(([option, path]) => `--${option}=${path}`)],
    of,
    job,
    places,
    options,
    outputs,
  };
}

/** A name for an output: what the same job made of the same file is made anew, all else stays. */
function free(path, of, read) {
  const [stem, ending] = parted(path);
  for (let number = 1; ; number++) {
    const name = number === 1 ? path : `${stem}_${number}${ending}`;
    if (!files.has(name) || (made.get(name) === of && !read.includes(name))) return name;
  }
}

/** A name and its ending. */
function parted(name) {
  const dot = name.lastIndexOf(".");
  return dot > 0 ? [name.slice(0, dot), name.slice(dot)] : [name, ""];
}

// Results

const STATUS = { 0: "done", 1: "refused", 2: "failed", 75: "later" };

/** Runs the form's call, shows what came of it; a corrected program is compared and drawn as well. */
async function submit(event) {
  event?.preventDefault();
  if (isBusy) return;
  const asked = call();
  by("results").hidden = false;
  by("found").replaceChildren();
  if (asked.said) return status(asked.said, "error");
  status(words().running);
  busy(true);
  try {
    const outputs = asked.outputs.map(([, path]) => path);
    const isCorrection = asked.job.id === "correct";
    const result = await run(isCorrection ? [...asked.args, "--progress=linuxcnc"] : asked.args, advance, outputs);
    const results = [result];
    keep(result, asked.of);
    if (isCorrection && result.status === 0 && files.get(outputs[0])?.size <= DRAWN_BYTES) {
      status(words().checking);
      // A comparison that was stopped takes nothing from the program.
      await compared(asked, outputs[0]).then(
        (drawn) => results.push(drawn),
        () => {},
      );
    }
    await found(asked, results);
  } catch (error) {
    const said = words();
    let text = `${said.crashed}: ${error.message}`;
    if (error.message === "stopped") text = said.stopped;
    else if (error.unread) text = said.unread(error.unread);
    else if (/memory|allocation/i.test(error.message)) text = said.memory;
    status(text, "error");
  }
  busy(false);
}

/** A corrected program against the posted one, as pages. */
async function compared(asked, output) {
  const [stem] = parted(output);
  const shared = asked.options.filter((option) => reads("check", option));
  const pages = [`${stem}_check.html`, `${stem}_path.html`].map((path) => free(path, asked.of, []));
  const places = [asked.places[0], output.startsWith("-") ? `./${output}` : output];
  const args = ["check", ...places, ...shared, `--html=${pages[0]}`, `--viewer=${pages[1]}`];
  const drawn = await run(args, undefined, pages);
  keep(drawn, asked.of);
  return drawn;
}

function reads(name, option) {
  const long = option.slice(2).split("=")[0];
  return described
    .get(language)
    .command.commands.find((inner) => inner.name === name)
    .arguments.some((argument) => argument.long === long);
}

/** Takes what a run made into the list. */
function keep(result, of) {
  for (const { path, blob } of result.outputs) {
    files.set(path, blob);
    made.set(path, made.get(path) ?? of);
  }
}

function status(text, tone = "") {
  by("status").textContent = text;
  by("status").className = tone;
}

/** Everything waits for a run, or no longer does. */
function busy(is) {
  isBusy = is;
  for (const id of ["run", "english", "russian"]) by(id).disabled = is;
  by("cancel").hidden = !is;
  by("progress").hidden = !is;
  by("progress").removeAttribute("value");
}

function advance(percent) {
  by("progress").value = percent;
}

/** What is written in a result's summary, for people. */
async function figures(path) {
  const said = words(),
    summary = JSON.parse(await files.get(path).text());
  const um = (value) =>
    typeof value === "number"
      ? `${value.toLocaleString(language, { maximumSignificantDigits: 3 })} ${said.um}`
      : said.unknown;
  const rows = [
    [said.before, um(summary.deviation_before_um)],
    [said.after, um(summary.deviation_after_um)],
    [said.control, um(summary.control_um)],
    [said.corrections, um(summary.largest_correction_um)],
    [said.blocks, `${summary.blocks_in}, ${summary.blocks_out}`],
  ];
  return part("dl", {}, ...rows.flatMap(([name, value]) => [part("dt", {}, name), part("dd", {}, value)]));
}

async function found(asked, results) {
  const said = words(),
    last = results[0];
  // A program that feeds nowhere has nothing to be drawn, which takes nothing from it.
  const unlike = results.find((result, at) => result.status === 1 && (at > 0 || result.outputs.length > 0));
  const isUnlike = last.status !== 2 && unlike !== undefined;
  const ended = isUnlike ? said.unlike : said[STATUS[last.status]];
  status(ended ?? `${said.crashed} (${last.status}).`, last.status === 0 && !isUnlike ? "good" : "error");
  const shown = by("found");
  const summary = new Map(asked.outputs).get("summary");
  if (last.status === 0 && files.has(summary)) shown.append(await figures(summary));
  for (const [wanted, path] of results.flatMap((result) => result.guessed))
    shown.append(part("p", { class: "muted" }, said.guessed(wanted.replace(/^\/+/, ""), path)));
  const messages = results.map((result) => result.messages).join("");
  const cards = questions((unlike ?? last).messages, asked.job);
  if (last.status !== 0) shown.append(...cards);
  const outputs = results.flatMap((result) => result.outputs);
  if (outputs.length) {
    shown.append(
      part(
        "ul",
        { class: "made" },
        ...outputs.map(({ path, blob }) =>
          part(
            "li",
            {},
            part("code", {}, path),
            ` ${size(blob.size)} `,
            save(path, blob),
            /\.html$/.test(path)
              ? part("button", { type: "button", onclick: (event) => look(path, event.target) }, said.open)
              : null,
          ),
        ),
      ),
    );
    if (outputs.length > 1) {
      shown.append(
        part(
          "button",
          {
            type: "button",
            onclick: async () => {
              const archive = await ask({ kind: "zip", files: outputs });
              download("vpost.zip", archive);
            },
          },
          said.all,
        ),
      );
    }
  }
  for (const [at, result] of results.entries()) {
    const printed = await result.printed.slice(0, SHOWN).text();
    if (printed) shown.append(part("h3", {}, at ? said.check : said.printed), part("pre", { tabindex: 0 }, printed));
  }
  if (last.status === 0) shown.append(...cards);
  // What is said besides, of settings that were found: no message of a code.
  const besides = last.messages.split(/^\S+\[VP\d{4}\]/m)[0].trim();
  if (cards.length && besides) shown.append(part("p", { class: "muted" }, besides));
  if (!cards.length && messages)
    shown.append(part("h3", {}, said.messages), part("pre", { tabindex: 0 }, messages.slice(0, SHOWN)));
  if (messages) shown.append(part("p", {}, `${said.messages}: `, save("messages.txt", new Blob([messages]))));
  if (asked.options.length && !files.has(SETTINGS)) {
    shown.append(
      part(
        "p",
        {},
        part(
          "button",
          {
            type: "button",
            onclick: (event) => {
              files.set(SETTINGS, new Blob([settings()]));
              made.set(SETTINGS, "");
              download(SETTINGS, files.get(SETTINGS));
              event.target.disabled = true;
              list();
            },
          },
          said.keep,
        ),
      ),
    );
  }
  const quoted = asked.args.map((word) => (/^[\w./=,:+-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`));
  shown.append(
    part("details", {}, part("summary", {}, said.copy), part("pre", { tabindex: 0 }, `vpost ${quoted.join(" ")}`)),
  );
  list();
  const viewer = outputs.find(({ path }) => /_path\.html$|viewer\.html$/.test(path));
  if (viewer) look(viewer.path);
  by("results-title").focus({ preventScroll: true });
  by("results").scrollIntoView({ block: "start" });
}

function download(name, blob) {
  const link = part("a", { href: URL.createObjectURL(blob), download: name.split("/").at(-1) });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

const save = (path, blob) =>
  part(
    "button",
    { type: "button", "aria-label": `${words().download}: ${path}`, onclick: () => download(path, blob) },
    words().download,
  );

/** A page of the command inside this one; it can run nothing but the viewer's own script, which the policy names. */
async function look(path, from) {
  by("looked")?.remove();
  const text = await files.get(path).text();
  const frame = part("iframe", { sandbox: "allow-scripts", title: path, srcdoc: text });
  const close = part(
    "button",
    {
      type: "button",
      onclick: () => {
        by("looked").remove();
        from?.focus();
      },
    },
    words().close,
  );
  by("found").append(part("div", { id: "looked" }, part("h3", {}, path, " ", close), frame));
  if (from) by("looked").scrollIntoView({ block: "start" });
}

/** Messages as questions, the first one open: each option that its text offers is one click away. */
function questions(messages, of) {
  const said = words();
  const all = messages.split(/\n(?=\S+\[VP\d{4}\])/).filter((text) => /^\S+\[VP\d{4}\]/.test(text));
  const card = (text, at) => {
    const [title, ...rest] = text.trim().split("\n");
    const offers = [...new Set([...text.matchAll(/`(--[a-z-]+(?:[ =][^`]*)?)`/g)].map(([, offer]) => offer))];
    const answers = offers.map((offer) => {
      const [, long, value] = /^--([a-z-]+)[ =]?(.*)$/s.exec(offer);
      return part("button", { type: "button", onclick: () => answer(of, long, value) }, offer);
    });
    // Source lines keep their columns, what to do is read as a sentence.
    const sentences = rest.filter((line) => /^[^\s\d]/.test(line));
    return part(
      "details",
      { class: "question", open: at === 0 },
      part("summary", {}, title),
      part("pre", { tabindex: 0 }, rest.filter((line) => !sentences.includes(line)).join("\n")),
      ...sentences.map((line) => part("p", {}, line)),
      answers.length ? part("p", { class: "row" }, `${said.answer}: `, ...answers) : null,
    );
  };
  return all.length ? [part("h3", {}, said.question), ...all.slice(0, CARDS).map(card)] : [];
}

/** Puts an answer into the form of the job that asked, and runs it; what only the person can say is left to them. */
function answer(of, long, offered) {
  job = of;
  const argument = command().arguments.find((argument) => argument.long === long);
  if (!argument) return;
  // Quotes are the shell's, numbers those of an example.
  const value = offered.replace(/^(["'])(.*)\1$/, "$2").replace(/(^|[=,])-?\d[\d.]*/g, "$1…");
  const isOpen = (!value && argument.value) || /…|[\s[]|(^|[=,])[A-Z]+(?=$|,)/.test(value);
  const kept = typed.get(long);
  typed.set(long, argument.value ? (argument.many && kept ? `${kept}\n${value}` : value) : "yes");
  show();
  const input = by(`field-${long}`);
  input?.closest("details")?.setAttribute("open", "");
  if (isOpen) {
    input?.focus();
    input?.scrollIntoView({ block: "center" });
  } else submit();
}

/** The options of the form that hold for a check as well, as settings that the command finds beside its program. */
function settings() {
  const isShared = ({ long }) => long && ["correct", "check"].every((name) => reads(name, `--${long}`));
  const found = command();
  const line = (argument) => {
    const given = typed.get(argument.long) || (argument.long === "machine" ? chosen(argument, found).value : "");
    if (!given) return "";
    const value = argument.many ? given.split("\n").filter(Boolean) : given;
    return `${argument.long} = ${argument.value ? JSON.stringify(value) : "true"}\n`;
  };
  return asks(found).filter(isShared).map(line).join("");
}

// All together

function jobs() {
  const said = words();
  by("jobs").replaceChildren(
    ...JOBS.map((each) =>
      part(
        "button",
        {
          type: "button",
          "aria-pressed": String(each === job),
          onclick: () => {
            job = each;
            show();
          },
        },
        said[each.id],
      ),
    ),
  );
}

function show() {
  document.documentElement.lang = language;
  document.title = words().title;
  for (const each of document.querySelectorAll("[data-word]")) each.textContent = words()[each.dataset.word];
  for (const [id, name] of [
    ["english", "en"],
    ["russian", "ru"],
  ])
    by(id).setAttribute("aria-pressed", String(name === language));
  by("pattern").replaceChildren(
    ...["", ...Object.keys(PATTERNS)].map((name) =>
      part("option", { value: name }, name ? words().patterns[name] : words().pattern),
    ),
  );
  jobs();
  list();
  form();
  by("foot").textContent = described.size ? `vpost ${[...described.values()][0].version}` : "";
}

async function speak(name) {
  language = name;
  if (!described.has(name)) {
    const { printed } = await run(["man", "--json"]);
    described.set(name, JSON.parse(await printed.text()));
  }
  if (!dialects.length) {
    const { printed } = await run(["grammar", "list"]);
    dialects = (await printed.text())
      .split("\n")
      .map((line) => /^([a-z0-9_]+)\b/.exec(line)?.[1])
      .filter(Boolean);
  }
  show();
}

function begin() {
  if (
    typeof WebAssembly === "undefined" ||
    typeof DecompressionStream === "undefined" ||
    typeof Worker === "undefined"
  ) {
    by("old").hidden = false;
    by("old").textContent = WORDS[language].old;
    return;
  }
  start();
  show();
  by("form").addEventListener("submit", submit);
  by("cancel").addEventListener("click", stop);
  by("english").addEventListener("click", () => speak("en"));
  by("russian").addEventListener("click", () => speak("ru"));
  for (const [button, input] of [
    ["choose", "picked"],
    ["folder", "picked-folder"],
  ]) {
    by(button).addEventListener("click", () => by(input).click());
    by(input).addEventListener("change", async () => {
      await takeAll([...by(input).files]);
      by(input).value = "";
    });
  }
  by("example").addEventListener("click", () => {
    for (const [path, text] of Object.entries(JSON.parse(by("example-files").textContent)))
      files.set(path, new Blob([text]));
    show();
  });
  by("pattern").addEventListener("change", () => {
    const [name, text] = PATTERNS[by("pattern").value] ?? ["", ""];
    by("typed-name").value = name;
    by("typed-text").value = text;
  });
  by("typed-take").addEventListener("click", () => {
    const name = by("typed-name").value.trim();
    if (!name) return by("typed-name").focus();
    files.set(name, new Blob([by("typed-text").value.replace(/\n*$/, "\n")]));
    show();
  });
  document.addEventListener("dragover", (event) => event.preventDefault());
  document.addEventListener("drop", (event) => {
    event.preventDefault();
    dropped(event.dataTransfer);
  });
  speak(language).catch((error) => {
    by("old").hidden = false;
    by("old").textContent = `${words().crashed}: ${error.message}`;
  });
}

begin();
