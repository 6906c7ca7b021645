// A link as a QR code, for tablets. Always dark on light: many cameras read nothing else.
import { encode } from 'uqr';

const quietZone = 4; // modules, of ISO/IEC 18004

export function QrCode({ app: text }: { app: string }) {
  const { data, size } = encode(text, { ecc: 'M', border: quietZone });
  const dark = data.flatMap((row, y) => row.map((isDark, x) => (isDark ? `M${x} ${y}h1v1h-1z` : '')));
  return (
    <svg class="qr-code" viewBox={`0 0 ${size} ${size}`} role="img" aria-label="The link for learners as a QR code" data-link={text}>
      <rect width={size} height={size} fill="#fff" />
      <path d={dark.join('')} fill="#000" shape-rendering="crispEdges" />
    </svg>
  );
}
