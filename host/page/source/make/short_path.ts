// The end of a path, which says most: "gaits/forward.simulation.xml".
export function shortPath(file: string): string {
  return file.split('/').slice(-2).join('/');
}
