// A browser with vpost.html in it, by lines of JSON: {"do": NAME, …} at standard input, an answer line for each.
//
//     node --experimental-websocket tests/judges/alone/page.mjs chromium vpost.html PROFILE_FOLDER
//
// The page is used as a person uses it: files are given to it, fields
// filled by their labels, buttons pressed by their names, what it says is read; none of its script is touched.

import { createInterface } from "node:readline";

import { browsers } from "../../page/browsers.mjs";

/** What stands on the page. */
const STATE = `(() => {
  const all = (what) => [...document.querySelectorAll(what)], said = document.getElementById("list-said");
  const line = all("#found summary").find((one) => one.textContent === "Command line for the same");
  return {
    status: document.getElementById("status").textContent,
    kind: document.getElementById("status").className,
    said: said.hidden ? "" : said.textContent,
    listed: all("#list tbody tr").map((row) => [row.cells[0].textContent, row.cells[1].textContent]),
    made: all("#found .made code").map((one) => one.textContent),
    found: document.getElementById("found").innerText,
    line: line ? line.parentElement.querySelector("pre").textContent : "",
  };
})()`;

/** Keeps what the page hands to the browser to be saved. */
const CATCH = `(() => {
  const blobs = new Map(), make = URL.createObjectURL;
  URL.createObjectURL = (blob) => { const url = make.call(URL, blob); blobs.set(url, blob); return url; };
  HTMLAnchorElement.prototype.click = function () { window.judgeSaved = [this.download, blobs.get(this.href)]; };
})()`;
const SAVED = `(async () => {
  const [name, blob] = window.judgeSaved, bytes = new Uint8Array(await blob.arrayBuffer());
  let text = "";
  for (let at = 0; at < bytes.length; at += 8192) text += String.fromCharCode(...bytes.subarray(at, at + 8192));
  return [name, btoa(text)];
})()`;

/** A drop of what an input of the judge's took: for browsers that are not asked for drags from outside. */
const OWN = `(() => {
  const own = document.createElement("input");
  document.body.append(Object.assign(own, { type: "file", multiple: true, id: "judge" }));
})()`;
const DROP = `(() => {
  const own = document.getElementById("judge"), dataTransfer = new DataTransfer(), bubbles = true, cancelable = true;
  for (const file of own.files) dataTransfer.items.add(file);
  document.getElementById("drop").dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles, cancelable }));
  own.remove();
})()`;

const press = (label) => `(() => {
  const isIt = (one) => (one.ariaLabel ?? one.textContent) === ${JSON.stringify(label)};
  const one = [...document.querySelectorAll("button")].find(isIt);
  one?.click();
  return Boolean(one);
})()`;

/** Fills the field whose label has this option, without a name the one that has none; says what cannot be chosen. */
const fill = (name, value) => `(() => {
  const [name, value] = ${JSON.stringify([name, value])}, labels = [...document.querySelectorAll("#form label")];
  const named = (one) => one.querySelector("code")?.textContent.trim() ?? "";
  const one = labels.find((one) => named(one) === (name && "--" + name))?.control;
  if (!one) return "no field";
  if (one.type === "checkbox") { if (one.checked !== value) one.click(); return ""; }
  one.value = value;
  for (const type of ["input", "change"]) one.dispatchEvent(new Event(type, { bubbles: true }));
  return one.value === value ? "" : "no such value: " + value;
})()`;

const [name, page, folder] = process.argv.slice(2);
const { evaluate, into, drag, told, end } = await browsers[name](page, folder);
const until = (script, seconds) =>
  evaluate(`new Promise((done) => {
    const end = performance.now() + ${seconds * 1000};
    const look = () => ((${script}) ? done(true) : performance.now() > end ? done(false) : setTimeout(look, 15));
    look();
  })`);
const hands = {
  open: async () =>
    (await until(`document.querySelector("#form select")`, 60)) ? evaluate(CATCH) : Promise.reject("no form"),
  /** `by`: "picked" and "picked-folder" as a dialog would, "drop" by an event, "drag" by the system. */
  give: async ({ files, by }) => {
    if (by === "drag") return drag(files);
    if (by !== "drop") return into(`#${by}`, files);
    await evaluate(OWN);
    await into("#judge", files);
    return evaluate(DROP);
  },
  /** Waits until the list has so many files, or says something. */
  listed: ({ count, seconds }) => until(`${STATE}.listed.length >= ${count} || ${STATE}.said`, seconds),
  fill: ({ name, value }) => evaluate(fill(name, value)),
  press: ({ label }) => evaluate(press(label)),
  begin: () => evaluate(`(document.getElementById("status").textContent = "", document.getElementById("run").click())`),
  ended: ({ seconds }) =>
    until(`document.getElementById("cancel").hidden && document.getElementById("status").textContent`, seconds),
  state: () => evaluate(STATE),
  /** A file by its button: [name, bytes as base64], null without a button. */
  take: async ({ name }) =>
    (await evaluate(`(window.judgeSaved = null, ${press(`Download: ${name}`)})`)) &&
    (await until("window.judgeSaved", 20))
      ? evaluate(SAVED)
      : null,
  /** Requests that leave the computer, messages of the console. */
  told: async () => told().map(({ method, params }) => `${method} ${JSON.stringify(params).slice(0, 300)}`),
};
for await (const line of createInterface({ input: process.stdin })) {
  const { do: what, ...how } = JSON.parse(line);
  const answer = await hands[what](how).then(
    (value) => ({ value: value ?? null }),
    (error) => ({ error: String(error) }),
  );
  console.log(JSON.stringify(answer));
}
end();
process.exit(0);
