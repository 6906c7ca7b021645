// The picture of a scenario: the robot on a strip of its world.
import type { GalleryPicture } from '../wire/messages.js';

const width = 1000; // of the coordinates
const height = 500;

function pointsOf(numbers: readonly number[]): string {
  let text = '';
  for (let i = 0; i + 1 < numbers.length; i += 2) text += `${numbers[i]},${numbers[i + 1]} `;
  return text;
}

function backwards(numbers: readonly number[]): number[] {
  const result: number[] = [];
  for (let i = numbers.length - 2; i >= 0; i -= 2) result.push(numbers[i] as number, numbers[i + 1] as number);
  return result;
}

// A side of a solid: its light, then its corners.
function Side({ side: [light = 2, ...corners] }: { side: readonly number[] }) {
  return <polygon class={`light-${light}`} points={pointsOf(corners)} />;
}

export function Picture({ picture, label, id }: { picture: GalleryPicture; label: string; id: string }) {
  const { ground, thickness, path, body, links } = picture;
  const front = ground.at(-1);
  return (
    <svg class="gallery-picture" id={id} role="img" aria-label={label} viewBox={`0 0 ${width} ${height}`} preserveAspectRatio="xMidYMid slice">
      <g class="ground">
        {ground.slice(0, -1).map((section, i) => (
          <polygon key={i} points={pointsOf([...section, ...backwards(ground[i + 1] as number[])])} />
        ))}
        {picture.lines.map((line, i) => (
          <polyline key={i} points={pointsOf(line)} />
        ))}
      </g>
      {path.length > 2 && (
        <g class="path">
          <polyline points={pointsOf(path)} />
          <circle cx={path[0]} cy={path[1]} r={9} />
        </g>
      )}
      {front !== undefined && <polygon class="cut" points={pointsOf([...front, width, height, 0, height])} />}
      <polyline class="shadow" points={pointsOf(picture.shadow)} style={{ strokeWidth: thickness }} />
      <g class="object">
        {picture.objects.map((side, i) => (
          <Side key={i} side={side} />
        ))}
      </g>
      {picture.ghosts.map((ghost, i) => (
        <polyline key={i} class="ghost" points={pointsOf(ghost)} style={{ strokeWidth: thickness * 0.8 }} />
      ))}
      <polyline
        class={links.length > 0 ? 'spine' : 'spine thick'}
        points={pointsOf(body)}
        style={{ strokeWidth: links.length > 0 ? thickness * 0.35 : thickness * 0.8 }}
      />
      {links.map(([isHead, ...sides], i) => (
        <g key={i} class={isHead === 1 ? 'link head' : 'link'}>
          {(sides as number[][]).map((side, k) => (
            <Side key={k} side={side} />
          ))}
        </g>
      ))}
      <circle class="head" cx={body[0]} cy={body[1]} r={thickness * (links.length > 0 ? 0.3 : 0.6)} />
    </svg>
  );
}
