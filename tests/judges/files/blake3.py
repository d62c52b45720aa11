"""BLAKE3 in plain Python, for manifests that are changed and sealed again. Slow; the published algorithm, nothing of the command's code."""

import struct

IV = (0x6A09E667, 0xBB67AE85, 0x3C6EF372, 0xA54FF53A, 0x510E527F, 0x9B05688C, 0x1F83D9AB, 0x5BE0CD19)
ORDER = (2, 6, 3, 10, 7, 0, 4, 13, 1, 11, 12, 5, 9, 14, 15, 8)
START, END, PARENT, ROOT = 1, 2, 4, 8
MASK = 0xFFFFFFFF


def compress(chain, block, counter, length, flags):
    state = list(chain) + list(IV[:4]) + [counter & MASK, counter >> 32, length, flags]

    def mix(a, b, c, d, x, y):
        for word, first, second in ((x, 16, 12), (y, 8, 7)):
            state[a] = (state[a] + state[b] + word) & MASK
            turned = state[d] ^ state[a]
            state[d] = (turned >> first | turned << (32 - first)) & MASK
            state[c] = (state[c] + state[d]) & MASK
            turned = state[b] ^ state[c]
            state[b] = (turned >> second | turned << (32 - second)) & MASK
    m = list(block)
    for _ in range(7):
        for i in range(4):
            mix(i, 4 + i, 8 + i, 12 + i, m[2 * i], m[2 * i + 1])
        for i in range(4):
            mix(i, 4 + (i + 1) % 4, 8 + (i + 2) % 4, 12 + (i + 3) % 4, m[8 + 2 * i], m[9 + 2 * i])
        m = [m[i] for i in ORDER]
    return [state[i] ^ state[i + 8] for i in range(8)]


def node(data, counter, root):
    """Chaining value of a run of bytes that begins at chunk `counter`."""
    if len(data) <= 1024:
        chain = IV
        blocks = [data[i:i + 64] for i in range(0, len(data), 64)] or [b""]
        for index, block in enumerate(blocks):
            flags = START * (index == 0) | (END | ROOT * root) * (index == len(blocks) - 1)
            chain = compress(chain, struct.unpack("<16I", block.ljust(64, b"\0")), counter, len(block), flags)
        return chain
    chunks = (len(data) - 1) // 1024
    left = 1024 * (1 << (chunks.bit_length() - 1))
    both = node(data[:left], counter, False) + node(data[left:], counter + left // 1024, False)
    return compress(IV, both, 0, 64, PARENT | ROOT * root)


def hexdigest(data):
    return struct.pack("<8I", *node(data, 0, True)).hex()
