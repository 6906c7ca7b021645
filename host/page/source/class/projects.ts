// The scenarios that can be handed out, found by words and put below headings.
import type { ClassProject } from '../wire/class_messages.js';

export function matching(projects: readonly ClassProject[], wanted: string): ClassProject[] {
  const words = wanted.toLowerCase().split(/\s+/).filter(Boolean);
  return projects.filter(({ file, group, title, text }) => {
    const all = `${title} ${text} ${group} ${file}`.toLowerCase();
    return words.every((word) => all.includes(word));
  });
}

// In the order in which the headings come first.
export function groupsOf(projects: readonly ClassProject[]): [string, ClassProject[]][] {
  const groups = new Map<string, ClassProject[]>();
  for (const project of projects) groups.set(project.group, [...(groups.get(project.group) ?? []), project]);
  return [...groups];
}
