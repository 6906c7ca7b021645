// A message of the program with the name of the joint, in place of its number from the head.
export function namedJoints(text: string, joints: readonly { name: string }[]): string {
  return text.replace(/\bjoint (\d+) \(0 is at the head\)/g, (all, number: string) => joints[Number(number)]?.name ?? all);
}
