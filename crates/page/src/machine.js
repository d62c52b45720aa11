// A computer of its own for the command, in memory: the part of WASI preview 1 that it uses. Files that were dropped are read
// piece by piece from where they lie; what is written grows here in pieces of a megabyte.

const OK = 0,
  BADF = 8,
  EXIST = 20,
  INVAL = 28,
  ISDIR = 31,
  NOENT = 44,
  NOSYS = 52,
  NOTDIR = 54,
  NOTEMPTY = 55,
  ROFS = 69;
const DIRECTORY = 3,
  REGULAR = 4;
const PIECE = 1 << 20;
/** Files are read in windows of this size. */
const WINDOW = 4 * PIECE;

/** What the program ended with. */
class Ended extends Error {
  constructor(status) {
    super(`status ${status}`);
    this.status = status;
  }
}

/** A file that was given and can be read no longer: changed, moved, or its disk is gone. */
class Unread extends Error {}

/** What changes with the bytes of a piece. */
function mark(bytes) {
  let mark = bytes.length;
  const words = new Uint32Array(bytes.buffer, 0, bytes.length >> 2);
  for (const word of words) mark = Math.imul(mark ^ word, 0x9e3779b1) ^ (mark >>> 15);
  for (const byte of bytes.subarray(words.length * 4)) mark = Math.imul(mark ^ byte, 0x9e3779b1);
  return mark;
}

/** A file that the person gave: read only, a window of it in memory; the same from first to last, or it is refused. */
class Given {
  constructor(path, blob) {
    this.path = path;
    this.blob = blob;
    this.from = 0;
    this.window = new Uint8Array(0);
    /** Of each window that was read. */
    this.marks = new Map();
  }
  get size() {
    return this.blob.size;
  }
  get modified() {
    return this.blob.lastModified ?? 0;
  }
  /** The window that begins at a place. */
  load(from) {
    let bytes;
    try {
      bytes = new Uint8Array(new FileReaderSync().readAsArrayBuffer(this.blob.slice(from, from + WINDOW)));
    } catch {
      throw new Unread(this.path);
    }
    // Not every browser says that a file changed since it was chosen.
    const found = mark(bytes);
    if (bytes.length !== Math.min(WINDOW, this.size - from) || (this.marks.get(from) ?? found) !== found) {
      throw new Unread(this.path);
    }
    this.marks.set(from, found);
    return bytes;
  }
  read(at, into) {
    if (at >= this.size) return 0;
    const from = Math.floor(at / WINDOW) * WINDOW;
    if (from !== this.from || this.window.length === 0) {
      this.window = this.load(from);
      this.from = from;
    }
    const part = this.window.subarray(at - from, at - from + into.length);
    into.set(part);
    return part.length;
  }
  /** Reads once more what was read. */
  reread() {
    for (const from of this.marks.keys()) this.load(from);
  }
  write() {
    return null;
  }
  cut() {
    return false;
  }
}

/** A file that the command writes. */
class Grown {
  constructor() {
    this.pieces = [];
    this.size = 0;
    this.modified = Date.now();
  }
  read(at, into) {
    let done = 0;
    while (done < into.length && at + done < this.size) {
      const place = at + done,
        inside = place % PIECE;
      const count = Math.min(PIECE - inside, into.length - done, this.size - place);
      into.set(this.pieces[Math.floor(place / PIECE)].subarray(inside, inside + count), done);
      done += count;
    }
    return done;
  }
  write(at, bytes) {
    let done = 0;
    while (done < bytes.length) {
      const place = at + done,
        inside = place % PIECE,
        which = Math.floor(place / PIECE);
      while (this.pieces.length <= which) this.pieces.push(new Uint8Array(PIECE));
      const count = Math.min(PIECE - inside, bytes.length - done);
      this.pieces[which].set(bytes.subarray(done, done + count), inside);
      done += count;
    }
    this.size = Math.max(this.size, at + done);
    return done;
  }
  cut(size) {
    // What lies behind the end is zero again when it grows.
    if (size < this.size) {
      this.pieces.length = Math.ceil(size / PIECE);
      this.pieces.at(-1)?.fill(0, ((size - 1) % PIECE) + 1);
    }
    while (this.pieces.length < Math.ceil(size / PIECE)) this.pieces.push(new Uint8Array(PIECE));
    this.size = size;
    return true;
  }
  blob() {
    const left = this.size % PIECE;
    const parts = this.pieces.map((piece, at) =>
      at + 1 === this.pieces.length && left ? piece.subarray(0, left) : piece,
    );
    return new Blob(parts);
  }
}

/** Names and what they stand for. */
class Folder {
  constructor() {
    this.entries = new Map();
  }
}

/** The files of one run. */
class Disk {
  constructor() {
    this.root = new Folder();
    /** Names that were asked for and found elsewhere: `[asked, found]`. */
    this.guessed = new Map();
  }
  /** Folder and last name of a path. */
  place(path, make) {
    const names = [];
    for (const name of path.split("/")) {
      if (name === "..") names.pop();
      else if (name && name !== ".") names.push(name);
    }
    let folder = this.root;
    const last = names.pop();
    for (const name of names) {
      let next = folder.entries.get(name);
      if (!next && make) folder.entries.set(name, (next = new Folder()));
      if (!(next instanceof Folder)) return [null, last];
      folder = next;
    }
    return [folder, last];
  }
  add(path, file) {
    const [folder, name] = this.place(path, true);
    folder.entries.set(name, file);
  }
  find(path) {
    const [folder, name] = this.place(path, false);
    if (name === undefined) return folder ?? this.root;
    return folder?.entries.get(name);
  }
  /** Files come without their folders: a table is taken by its name from those that came so. Settings are not, for they
   * hold where they lie. */
  findGiven(path) {
    const found = this.find(path);
    if (found) return found;
    const name = path.split("/").at(-1);
    const bare = this.root.entries.get(name);
    if (!(bare instanceof Given) || name === "vpost.toml") return undefined;
    this.guessed.set(path, name);
    return bare;
  }
  *files(folder = this.root, above = "") {
    for (const [name, entry] of folder.entries) {
      if (entry instanceof Folder) yield* this.files(entry, `${above}${name}/`);
      else yield [above + name, entry];
    }
  }
}

/** One run of the command. `said` is told each piece of standard error. */
class Machine {
  constructor(args, environment, disk, said) {
    this.disk = disk;
    [this.args, this.environment] = [args, environment].map((texts) =>
      texts.map((text) => new TextEncoder().encode(`${text}\0`)),
    );
    this.out = new Grown();
    this.said = said;
    this.open = new Map([
      [0, { file: new Grown(), at: 0 }],
      [1, { file: this.out, at: 0 }],
      [2, { file: null, at: 0 }],
      [3, { file: disk.root, path: "", at: 0 }],
    ]);
    this.next = 4;
  }

  /** Runs the module from its start; gives the exit status. */
  run(module) {
    const instance = new WebAssembly.Instance(module, { wasi_snapshot_preview1: this.calls() });
    this.memory = instance.exports.memory;
    try {
      instance.exports._start();
      return 0;
    } catch (error) {
      if (error instanceof Ended) return error.status;
      throw error;
    }
  }

  get view() {
    return new DataView(this.memory.buffer);
  }
  bytes(at, length) {
    return new Uint8Array(this.memory.buffer, at, length);
  }
  text(at, length) {
    return new TextDecoder().decode(this.bytes(at, length).slice());
  }
  path(descriptor, at, length) {
    const above = this.open.get(descriptor)?.path ?? "";
    return `${above}/${this.text(at, length)}`;
  }

  /** Reads or writes a list of buffers; gives an error number. */
  vectors(at, count, done, each) {
    let sum = 0;
    for (let k = 0; k < count; k++) {
      const buffer = this.bytes(this.view.getUint32(at + 8 * k, true), this.view.getUint32(at + 8 * k + 4, true));
      const moved = each(buffer, sum);
      if (moved === null) return ROFS;
      sum += moved;
      if (moved < buffer.length) break;
    }
    this.view.setUint32(done, sum, true);
    return OK;
  }

  /** 64 bytes about a file. */
  stat(file, at) {
    const time = BigInt(Math.round((file?.modified ?? 0) * 1e6));
    const view = this.view;
    for (let k = 0; k < 64; k += 8) view.setBigUint64(at + k, 0n, true);
    view.setUint8(at + 16, file instanceof Folder ? DIRECTORY : REGULAR);
    view.setBigUint64(at + 24, 1n, true);
    view.setBigUint64(at + 32, BigInt(file instanceof Folder ? 0 : (file?.size ?? 0)), true);
    for (const k of [40, 48, 56]) view.setBigUint64(at + k, time, true);
    return OK;
  }

  list(at, buffer, texts) {
    for (const [k, text] of texts.entries()) {
      this.view.setUint32(at + 4 * k, buffer, true);
      this.bytes(buffer, text.length).set(text);
      buffer += text.length;
    }
    return OK;
  }

  sizes(count, size, texts) {
    this.view.setUint32(count, texts.length, true);
    this.view.setUint32(
      size,
      texts.reduce((sum, text) => sum + text.length, 0),
      true,
    );
    return OK;
  }

  /** A file of an open descriptor, for `use`. */
  with(descriptor, use) {
    const opened = this.open.get(descriptor);
    return opened ? use(opened) : BADF;
  }

  calls() {
    const calls = {
      args_sizes_get: (count, size) => this.sizes(count, size, this.args),
      args_get: (at, buffer) => this.list(at, buffer, this.args),
      environ_sizes_get: (count, size) => this.sizes(count, size, this.environment),
      environ_get: (at, buffer) => this.list(at, buffer, this.environment),
      clock_time_get: (clock, precision, at) => {
        const now = clock === 0 ? Date.now() : performance.now();
        this.view.setBigUint64(at, BigInt(Math.round(now * 1e6)), true);
        return OK;
      },
      random_get: (at, length) => {
        for (let from = 0; from < length; from += 65536) {
          crypto.getRandomValues(this.bytes(at + from, Math.min(65536, length - from)));
        }
        return OK;
      },
      sched_yield: () => OK,
      proc_exit: (status) => {
        throw new Ended(status);
      },
      fd_close: (descriptor) => (this.open.delete(descriptor) ? OK : BADF),
      fd_sync: () => OK,
      fd_datasync: () => OK,
      fd_filestat_set_times: () => OK,
      fd_fdstat_set_flags: () => OK,
      fd_fdstat_get: (descriptor, at) =>
        this.with(descriptor, ({ file }) => {
          this.view.setUint8(at, file instanceof Folder ? DIRECTORY : REGULAR);
          this.view.setUint16(at + 2, 0, true);
          this.view.setBigUint64(at + 8, 0xffffffffffffffffn, true);
          this.view.setBigUint64(at + 16, 0xffffffffffffffffn, true);
          return OK;
        }),
      fd_filestat_get: (descriptor, at) => this.with(descriptor, ({ file }) => this.stat(file, at)),
      fd_filestat_set_size: (descriptor, size) =>
        this.with(descriptor, ({ file }) => (file?.cut?.(Number(size)) ? OK : INVAL)),
      fd_prestat_get: (descriptor, at) => {
        if (descriptor !== 3) return BADF;
        this.view.setUint8(at, 0);
        this.view.setUint32(at + 4, 1, true);
        return OK;
      },
      fd_prestat_dir_name: (descriptor, at) => {
        this.bytes(at, 1)[0] = 0x2f;
        return OK;
      },
      fd_read: (descriptor, at, count, done) =>
        this.with(descriptor, (opened) => {
          if (!opened.file || opened.file instanceof Folder) return ISDIR;
          const ended = this.vectors(at, count, done, (buffer, sum) => opened.file.read(opened.at + sum, buffer));
          opened.at += this.view.getUint32(done, true);
          return ended;
        }),
      fd_pread: (descriptor, at, count, from, done) =>
        this.with(descriptor, ({ file }) => {
          if (!file || file instanceof Folder) return ISDIR;
          return this.vectors(at, count, done, (buffer, sum) => file.read(Number(from) + sum, buffer));
        }),
      fd_write: (descriptor, at, count, done) =>
        this.with(descriptor, (opened) => {
          if (descriptor === 2) {
            return this.vectors(at, count, done, (buffer) => {
              this.said(buffer.slice());
              return buffer.length;
            });
          }
          if (opened.isAppended) opened.at = opened.file.size;
          const ended = this.vectors(at, count, done, (buffer, sum) => opened.file.write(opened.at + sum, buffer));
          if (ended === OK) opened.at += this.view.getUint32(done, true);
          return ended;
        }),
      fd_seek: (descriptor, offset, whence, at) =>
        this.with(descriptor, (opened) => {
          const base = whence === 0 ? 0 : whence === 1 ? opened.at : (opened.file?.size ?? 0);
          const place = base + Number(offset);
          if (place < 0) return INVAL;
          opened.at = place;
          this.view.setBigUint64(at, BigInt(place), true);
          return OK;
        }),
      fd_tell: (descriptor, at) =>
        this.with(descriptor, (opened) => {
          this.view.setBigUint64(at, BigInt(opened.at), true);
          return OK;
        }),
      fd_readdir: (descriptor, buffer, length, cookie, used) =>
        this.with(descriptor, ({ file }) => {
          if (!(file instanceof Folder)) return NOTDIR;
          const into = this.bytes(buffer, length);
          let filled = 0;
          for (const [k, [name, entry]] of [...file.entries].entries()) {
            if (k < Number(cookie)) continue;
            const text = new TextEncoder().encode(name);
            const row = new Uint8Array(24 + text.length);
            const view = new DataView(row.buffer);
            view.setBigUint64(0, BigInt(k + 1), true);
            view.setBigUint64(8, BigInt(k + 1), true);
            view.setUint32(16, text.length, true);
            view.setUint8(20, entry instanceof Folder ? DIRECTORY : REGULAR);
            row.set(text, 24);
            into.set(row.subarray(0, length - filled), filled);
            filled = Math.min(length, filled + row.length);
            if (filled === length) break;
          }
          this.view.setUint32(used, filled, true);
          return OK;
        }),
      path_open: (descriptor, follow, at, length, flags, rights, inherited, ways, into) => {
        const [create, isFolder, exclusive, truncate] = [1, 2, 4, 8].map((bit) => (flags & bit) !== 0);
        const path = this.path(descriptor, at, length);
        const [folder, name] = this.disk.place(path, false);
        let file = create ? this.disk.find(path) : this.disk.findGiven(path);
        if (file && create && exclusive) return EXIST;
        if (!file) {
          if (!create || !folder) return NOENT;
          folder.entries.set(name, (file = new Grown()));
        }
        if (isFolder && !(file instanceof Folder)) return NOTDIR;
        if (truncate && !file.cut?.(0)) return file instanceof Folder ? ISDIR : ROFS;
        this.open.set(this.next, { file, path, at: 0, isAppended: (ways & 1) !== 0 });
        this.view.setUint32(into, this.next++, true);
        return OK;
      },
      path_filestat_get: (descriptor, flags, at, length, into) => {
        const file = this.disk.findGiven(this.path(descriptor, at, length));
        return file ? this.stat(file, into) : NOENT;
      },
      path_readlink: (descriptor, at, length) => (this.disk.find(this.path(descriptor, at, length)) ? INVAL : NOENT),
      path_create_directory: (descriptor, at, length) => {
        const [folder, name] = this.disk.place(this.path(descriptor, at, length), false);
        if (!folder) return NOENT;
        if (name === undefined || folder.entries.has(name)) return EXIST;
        folder.entries.set(name, new Folder());
        return OK;
      },
      path_unlink_file: (descriptor, at, length) => {
        const [folder, name] = this.disk.place(this.path(descriptor, at, length), false);
        if (folder?.entries.get(name) instanceof Folder) return ISDIR;
        return folder?.entries.delete(name) ? OK : NOENT;
      },
      path_remove_directory: (descriptor, at, length) => {
        const [folder, name] = this.disk.place(this.path(descriptor, at, length), false);
        const entry = folder?.entries.get(name);
        if (!(entry instanceof Folder)) return entry ? NOTDIR : NOENT;
        if (entry.entries.size) return NOTEMPTY;
        folder.entries.delete(name);
        return OK;
      },
      path_rename: (from, at, length, to, newAt, newLength) => {
        const [folder, name] = this.disk.place(this.path(from, at, length), false);
        const [newFolder, newName] = this.disk.place(this.path(to, newAt, newLength), false);
        const entry = folder?.entries.get(name);
        if (!entry || !newFolder || newName === undefined) return NOENT;
        folder.entries.delete(name);
        newFolder.entries.set(newName, entry);
        return OK;
      },
      // A second name is what a rename that must not overwrite is made of.
      path_link: (from, flags, at, length, to, newAt, newLength) => {
        const file = this.disk.find(this.path(from, at, length));
        const [folder, name] = this.disk.place(this.path(to, newAt, newLength), false);
        if (!file || !folder) return NOENT;
        if (folder.entries.has(name)) return EXIST;
        folder.entries.set(name, file);
        return OK;
      },
    };
    // What no file in memory needs.
    return new Proxy(calls, { get: (own, name) => own[name] ?? (() => NOSYS) });
  }
}
