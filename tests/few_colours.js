// A PNG in base64 to the same in at most 256 colours: frequent ones and such as no other comes near; for each other one
// the nearest of them.
async text => {
    const MOST = 256;
    const image = await createImageBitmap(new Blob([Uint8Array.from(atob(text), c => c.charCodeAt(0))]));
    const { width, height } = image;
    const room = new OffscreenCanvas(width, height).getContext('2d');
    room.drawImage(image, 0, 0);
    const pixels = new Uint32Array(room.getImageData(0, 0, width, height).data.buffer);

    const counts = new Map();
    for (const pixel of pixels) counts.set(pixel, (counts.get(pixel) ?? 0) + 1);
    // Equally frequent ones in an order of their own, so that the same page has the same bytes.
    const colours = [...counts.keys()].sort((a, b) => counts.get(b) - counts.get(a) || a - b).map(colour => {
        const parts = [colour & 255, colour >> 8 & 255, colour >> 16 & 255];
        return { colour, parts, weight: Math.sqrt(counts.get(colour)), place: 0, far: Infinity };
    });
    // Each is the one that is missed most: the root of how often it is there, by how far it is from those before.
    const kept = [];
    while (kept.length < Math.min(MOST, colours.length)) {
        const missed = one => one.weight * one.far;
        const next = kept.length ? colours.reduce((most, one) => (missed(one) > missed(most) ? one : most)) : colours[0];
        for (const one of colours) {
            const far = one.parts.reduce((sum, part, k) => sum + (part - next.parts[k]) ** 2, 0);
            if (far < one.far) [one.far, one.place] = [far, kept.length];
        }
        kept.push(next.parts);
    }
    const places = new Map(colours.map(one => [one.colour, one.place]));

    // A row is its filter, none, and its places in the palette.
    const rows = new Uint8Array(height * (width + 1));
    for (let y = 0; y < height; y++) {
        for (let x = 0; x < width; x++) rows[y * (width + 1) + 1 + x] = places.get(pixels[y * width + x]);
    }
    const pressed = new Blob([rows]).stream().pipeThrough(new CompressionStream('deflate'));

    const whole = n => [n >>> 24, n >>> 16 & 255, n >>> 8 & 255, n & 255];
    const check = bytes => {
        let sum = -1;
        for (const byte of bytes) {
            sum ^= byte;
            for (let k = 0; k < 8; k++) sum = sum >>> 1 ^ (sum & 1 ? 0xedb88320 : 0);
        }
        return whole(~sum);
    };
    const chunk = (name, data) => {
        const named = [...name].map(c => c.charCodeAt(0)).concat(Array.from(data));
        return [...whole(data.length), ...named, ...check(named)];
    };
    const bytes = [
        ...[0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a],
        // 8 bits, a palette.
        ...chunk('IHDR', [...whole(width), ...whole(height), 8, 3, 0, 0, 0]),
        ...chunk('PLTE', kept.flat()),
        ...chunk('IDAT', new Uint8Array(await new Response(pressed).arrayBuffer())),
        ...chunk('IEND', []),
    ];
    return btoa(bytes.reduce((text, byte) => text + String.fromCharCode(byte), ''));
}
