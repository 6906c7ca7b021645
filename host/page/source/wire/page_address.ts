// Where the program of a page is. In a class many programs share an origin: each seat has its own path, `/robots/N/`.

export interface PageAddress {
  folder: string; // path of the page: "/", or that of a seat
  socket: string;
  stop: string; // path for POST
  isSeat: boolean;
  onlyLooks: boolean; // the page of a teacher who looks at the robot of a learner
}

export function pageAddress(location: Pick<Location, 'protocol' | 'host' | 'pathname' | 'search'>): PageAddress {
  const folder = location.pathname.slice(0, location.pathname.lastIndexOf('/') + 1);
  const onlyLooks = location.search === '?look';
  return {
    folder,
    socket: socketAddress(location, folder, onlyLooks),
    stop: `${folder}stop`,
    isSeat: folder !== '/',
    onlyLooks,
  };
}

// The address of the connection below a path.
export function socketAddress({ protocol, host }: Pick<Location, 'protocol' | 'host'>, folder: string, onlyLooks: boolean): string {
  return `${protocol === 'https:' ? 'wss' : 'ws'}://${host}${folder}socket${onlyLooks ? '?look' : ''}`;
}
