// What the scripts of the page take from other projects.
declare const uPlot: any;
