// A robot of the class: who has it, a live picture, how it is, and what the teacher can do with it.
import { effect } from '@preact/signals-core';
import { useEffect, useMemo, useRef } from 'preact/hooks';
import { isDark } from '../view/theme.js';
import type { ClassSeat } from '../wire/messages.js';
import type { ClassApp } from './class_app.js';
import { darkColours, lightColours, RobotPicture } from './robot_picture.js';
import { distanceText, seatAddress, speedText, tileProblem, tileState } from './tile_text.js';
import type { Tile } from './tiles.js';

function drawTile(canvas: HTMLCanvasElement, picture: RobotPicture, tile: Tile): void {
  const row = tile.row.value;
  const colours = isDark.value ? darkColours : lightColours;
  const context = canvas.getContext('2d');
  if (row === null || context === null) return;
  const ratio = window.devicePixelRatio;
  const { clientWidth: width, clientHeight: height } = canvas;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  picture.draw(context, width, height, row, colours);
}

function Picture({ name, tile }: { name: string; tile: Tile }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const robot = tile.robot.value;
  const picture = useMemo(() => (robot === null ? null : new RobotPicture(robot)), [robot]);
  useEffect(() => (picture === null ? undefined : effect(() => drawTile(canvas.current as HTMLCanvasElement, picture, tile))), [picture]);
  return <canvas ref={canvas} class="tile-picture" role="img" aria-label={`The robot of ${name}`} />;
}

function Figures({ tile }: { tile: Tile }) {
  const session = tile.session.value;
  return (
    <dl class="figures">
      <div title="Over the last two strides">
        <dt>speed</dt>
        <dd data-testid="speed">{speedText(session?.speed)}</dd>
      </div>
      <div title="In a straight line from where the run began">
        <dt>distance</dt>
        <dd data-testid="distance">{distanceText(session?.distance)}</dd>
      </div>
    </dl>
  );
}

export function TileView({ app, seat }: { app: ClassApp; seat: ClassSeat }) {
  const tile = app.tileOf(seat.seat);
  const session = tile.session.value;
  const state = tileState(seat, session);
  const problem = tileProblem(seat, session);
  const isTeacher = seat.seat === 0;
  const name = isTeacher ? 'My robot' : seat.name;
  const about = `${name}: `;
  return (
    <li class={`tile ${state.kind}`} data-seat={seat.seat}>
      <div class="tile-head">
        <h2 title={name}>{name}</h2>
        {session?.isRecording && <span class="hint">records</span>}
        <span class={`state ${state.kind}`} data-testid="tile-state">
          {state.text}
        </span>
      </div>
      <Picture name={name} tile={tile} />
      <Figures tile={tile} />
      <p class="tile-problem" title={problem ?? undefined}>
        {problem}
      </p>
      <div class="tile-buttons">
        <a class="button" href={seatAddress(seat)} target="_blank" rel="noopener" aria-label={`${about}Open`}>
          Open
        </a>
        {!isTeacher && (
          <>
            <button type="button" aria-label={`${about}Message`} onClick={() => app.show({ kind: 'message', seat })}>
              Message
            </button>
            <button type="button" aria-label={`${about}Hand out`} onClick={() => app.show({ kind: 'hand_out', seat })}>
              Hand out
            </button>
          </>
        )}
        <button type="button" aria-label={`${about}More`} title="Let in again, start again, remove" onClick={() => app.show({ kind: 'seat', seat })}>
          More …
        </button>
      </div>
    </li>
  );
}
