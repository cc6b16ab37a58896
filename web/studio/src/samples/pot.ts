// A teapot: one piece with a hole, inside its handle.
export const pot = `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 760 600" width="760" height="600">
<g stroke="#1d3d5c" stroke-width="10" stroke-linejoin="round">
<path fill="#4f8fc0" fill-rule="evenodd" d="M232 198c-30-22-76-26-114-6C66 220 46 276 64 332c18 54 66 88 120 90l22-2 8-46c-46 8-88-12-104-50-16-40-2-82 34-102 24-12 50-12 70 0z"/>
<path fill="#4f8fc0" d="M520 330c52-12 72-44 84-92 12-50 34-82 92-98 14-2 22 12 16 26-42 20-50 52-56 100-8 72-44 138-122 164z"/>
<path fill="#5fa3d6" d="M370 150c128 0 206 84 206 194 0 86-52 164-112 196H276c-60-32-112-110-112-196 0-110 78-194 206-194z"/>
<path fill="#e9b44c" d="M252 540h236c10 0 16 8 14 16-2 10-8 16-16 16H254c-8 0-14-6-16-16-2-8 4-16 14-16z"/>
<path fill="#e9b44c" d="M252 176c20-34 66-54 118-54s98 20 118 54c6 12-2 22-14 22H266c-12 0-20-10-14-22z"/>
<circle cx="370" cy="88" r="36" fill="#d9534b"/>
</g>
<path fill="none" stroke="#fff6e6" stroke-width="10" stroke-linecap="round" d="M216 420c50 34 102-34 154 0s104-34 154 0"/>
<g fill="#fff6e6"><circle cx="260" cy="470" r="8"/><circle cx="333" cy="474" r="8"/><circle cx="407" cy="474" r="8"/><circle cx="480" cy="470" r="8"/></g>
<g fill="#17293b"><ellipse cx="316" cy="300" rx="15" ry="20"/><ellipse cx="424" cy="300" rx="15" ry="20"/></g>
<g fill="#fff"><circle cx="321" cy="293" r="5"/><circle cx="429" cy="293" r="5"/></g>
<g fill="#f2a39a"><circle cx="276" cy="340" r="18"/><circle cx="464" cy="340" r="18"/></g>
<path d="M338 346c18 22 46 22 64 0" fill="none" stroke="#17293b" stroke-width="9" stroke-linecap="round"/>
<path d="M222 262c16-30 42-48 70-56" fill="none" stroke="#bfe0f5" stroke-width="12" stroke-linecap="round"/>
<circle cx="358" cy="76" r="9" fill="#f6b9b4"/>
</svg>`;
