// What runs beside the page, so that the page never waits: the command, and archives. Stands behind machine.js in one text.

let compiled;

/** The bytes of a block of base64 that was packed with gzip. */
async function unpacked(text) {
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

/** Runs the command; its progress is told as it comes. */
async function ran({ args, language, files }) {
  const disk = new Disk();
  for (const { path, blob } of files) disk.add(path, new Given(path, blob));
  const decoder = new TextDecoder();
  let messages = "",
    line = "";
  const say = (text) => {
    const lines = (line + text).split("\n");
    line = lines.pop();
    for (const each of lines) {
      const share = /^FILTER_PROGRESS=(\d+)$/.exec(each);
      if (share) postMessage({ kind: "progress", percent: Number(share[1]) });
      else messages += `${each}\n`;
    }
  };
  const machine = new Machine(["vpost", ...args], [`LANG=${language}`], disk, (bytes) =>
    say(decoder.decode(bytes, { stream: true })),
  );
  const status = machine.run(await compiled);
  messages += line;
  for (const [, file] of disk.files()) if (file instanceof Given) file.reread();
  const outputs = [...disk.files()]
    .filter(([path, file]) => file instanceof Grown && !path.split("/").at(-1).startsWith(".vpost-"))
    .map(([path, file]) => ({ path, blob: file.blob() }));
  return { status, messages, printed: machine.out.blob(), outputs, guessed: [...disk.guessed] };
}

/** A name of an archive: Linux and new programs write UTF-8, Russian Windows as DOS did, and not all say which. */
function named(bytes) {
  try {
    return new TextDecoder("utf-8", { fatal: true }).decode(bytes);
  } catch {
    return new TextDecoder("ibm866").decode(bytes);
  }
}

/** The files of a zip archive, each as its checksum says. */
async function unzipped(archive) {
  const ends = async (from, to) => new DataView(await archive.slice(from, to).arrayBuffer());
  const tail = Math.min(archive.size, 65557);
  const last = await ends(archive.size - tail, archive.size);
  let at = tail - 22;
  while (at >= 0 && last.getUint32(at, true) !== 0x06054b50) at--;
  if (at < 0) throw new Error("zip");
  const count = last.getUint16(at + 10, true);
  const from = last.getUint32(at + 16, true);
  const list = await ends(from, from + last.getUint32(at + 12, true));
  const files = [];
  let row = 0;
  for (let k = 0; k < count; k++) {
    const [method, packed] = [list.getUint16(row + 10, true), list.getUint32(row + 20, true)];
    const lengths = [28, 30, 32].map((offset) => list.getUint16(row + offset, true));
    const isLocked = (list.getUint16(row + 8, true) & 1) !== 0;
    const name = new Uint8Array(list.buffer, list.byteOffset + row + 46, lengths[0]);
    const path = named(name).replaceAll("\\", "/");
    const head = list.getUint32(row + 42, true);
    const own = await ends(head, head + 30);
    const start = head + 30 + own.getUint16(26, true) + own.getUint16(28, true);
    const body = archive.slice(start, start + packed);
    if (!path.endsWith("/")) {
      if (isLocked || (method !== 0 && method !== 8)) throw new Error("zip");
      const stream = body.stream().pipeThrough(new DecompressionStream("deflate-raw"));
      const blob = method === 0 ? body : await new Response(stream).blob();
      if (crc(new Uint8Array(await blob.arrayBuffer())) !== list.getUint32(row + 16, true)) throw new Error("zip");
      files.push({ path, blob });
    }
    row += 46 + lengths[0] + lengths[1] + lengths[2];
  }
  return files;
}

const CRC = Uint32Array.from({ length: 256 }, (_, k) => {
  for (let bit = 0; bit < 8; bit++) k = k & 1 ? (k >>> 1) ^ 0xedb88320 : k >>> 1;
  return k;
});

function crc(bytes) {
  let crc = ~0;
  for (const byte of bytes) crc = CRC[(crc ^ byte) & 255] ^ (crc >>> 8);
  return ~crc >>> 0;
}

/** A zip archive of files, stored as they are; its dates are the format's first day, so that it is the same each time. */
async function zipped(files) {
  const parts = [],
    list = [];
  let at = 0;
  for (const { path, blob } of files) {
    const name = new TextEncoder().encode(path);
    const sum = crc(new Uint8Array(await blob.arrayBuffer()));
    const fields = (view, from) => {
      for (const [offset, value] of [
        [0, 20],
        [2, 0x800],
        [4, 0],
        [6, 0],
        [8, 33],
      ])
        view.setUint16(from + offset, value, true);
      for (const [offset, value] of [
        [10, sum],
        [14, blob.size],
        [18, blob.size],
      ])
        view.setUint32(from + offset, value >>> 0, true);
      view.setUint16(from + 22, name.length, true);
    };
    const head = new DataView(new ArrayBuffer(30)),
      row = new DataView(new ArrayBuffer(46));
    head.setUint32(0, 0x04034b50, true);
    fields(head, 4);
    row.setUint32(0, 0x02014b50, true);
    row.setUint16(4, 20, true);
    fields(row, 6);
    row.setUint32(42, at, true);
    parts.push(head.buffer, name, blob);
    list.push(row.buffer, name);
    at += 30 + name.length + blob.size;
  }
  const length = new Blob(list).size,
    end = new DataView(new ArrayBuffer(22));
  end.setUint32(0, 0x06054b50, true);
  for (const offset of [8, 10]) end.setUint16(offset, files.length, true);
  end.setUint32(12, length, true);
  end.setUint32(16, at, true);
  return new Blob([...parts, ...list, end.buffer], { type: "application/zip" });
}

const TASKS = { run: ran, unzip: ({ blob }) => unzipped(blob), zip: ({ files }) => zipped(files) };

onmessage = async ({ data }) => {
  if (data.kind === "start") {
    compiled = unpacked(data.text).then((bytes) => WebAssembly.compile(bytes));
    compiled.catch((error) => postMessage({ kind: "failed", text: String(error) }));
    return;
  }
  try {
    postMessage({ kind: "done", result: await TASKS[data.kind](data) });
  } catch (error) {
    postMessage({ kind: "failed", text: String(error), unread: error instanceof Unread ? error.message : undefined });
  }
};
