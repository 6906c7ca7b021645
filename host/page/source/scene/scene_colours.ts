// Colours of the 3D view, light and dark.
import { Color } from 'three';

export interface SceneColours {
  background: Color;
  floor: Color;
  obstacle: Color;
  object: Color;
  rulerOdd: Color;
  rulerEven: Color;
  grid: Color;
  link: Color;
  head: Color;
  ghost: Color;
  joint: Color;
  highlight: Color;
  contact: Color;
  noContact: Color;
  path: Color;
}

const make = (values: Record<keyof SceneColours, number>): SceneColours =>
  Object.fromEntries(Object.entries(values).map(([name, value]) => [name, new Color(value)])) as unknown as SceneColours;

const light = make({
  background: 0xe9edf2,
  floor: 0xd9dee5,
  obstacle: 0xb9a88a,
  object: 0x3f9e6b,
  rulerOdd: 0xedae49,
  rulerEven: 0xd1495b,
  grid: 0xa9b2be,
  link: 0x6f8fb5,
  head: 0x2f6fbf,
  ghost: 0x0f9d7a,
  joint: 0x3d4653,
  highlight: 0xe69f00,
  contact: 0xff4d1a,
  noContact: 0xc3ccd8,
  path: 0x9a3fb0,
});

const dark = make({
  background: 0x14181e,
  floor: 0x2a3038,
  obstacle: 0x6b5d45,
  object: 0x58c98d,
  rulerOdd: 0xd9a23f,
  rulerEven: 0xc2404f,
  grid: 0x4a5461,
  link: 0x7f9fc6,
  head: 0x4d9bff,
  ghost: 0x5fe0bd,
  joint: 0xb8c2cf,
  highlight: 0xffb833,
  contact: 0xff6a33,
  noContact: 0x3c4653,
  path: 0xd17be6,
});

export function colours(isDark: boolean): SceneColours {
  return isDark ? dark : light;
}
