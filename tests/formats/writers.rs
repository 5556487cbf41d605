//! Small writers of every particle format, from one sample.

use std::fmt::Write as _;
use std::io::Write as _;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::{GzEncoder, ZlibEncoder};

/// Particles with values that a careless conversion changes.
#[derive(Clone)]
pub struct Sample {
    pub position: Vec<[f32; 3]>,
    pub id: Vec<i32>,
    pub velocity: Vec<[f32; 3]>,
    pub mass: Vec<f64>,
}

impl Sample {
    pub fn new(count: usize) -> Self {
        let awkward = [-0.0, 1.0e-42, 3.0e38, -1.0 / 3.0, f32::MIN_POSITIVE, 16_777_217.0, 0.1];
        let number = |i: usize| match (awkward[i % awkward.len()], i / awkward.len()) {
            (plain, 0) => plain,
            (plain, turn) => plain + turn as f32 * 0.37,
        };
        let triple = |i: usize, by: usize| [number(by * i), number(by * i + 1), number(by * i + 2)];
        Self {
            position: (0..count).map(|i| triple(i, 3)).collect(),
            id: (0..count).map(|i| (i as i32).wrapping_mul(0x4567_8901)).collect(),
            velocity: (0..count).map(|i| triple(i, 5)).collect(),
            mass: (0..count).map(|i| 1.0 / (i as f64 + 3.0)).collect(),
        }
    }

    /// Numbers into the texts `drop` and `bubble`.
    pub fn kinds(&self) -> Vec<i32> {
        (0..self.len() as i32).map(|i| i % 2).collect()
    }

    pub fn len(&self) -> usize {
        self.position.len()
    }
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Order {
    Big,
    Little,
}

/// Numbers as bytes of either order, or as text.
pub trait Encode: Copy + std::fmt::Display {
    fn bytes(self, order: Order) -> Vec<u8>;
}

macro_rules! encode {
    ($($type:ty)*) => { $(
        impl Encode for $type {
            fn bytes(self, order: Order) -> Vec<u8> {
                match order {
                    Order::Big => self.to_be_bytes().to_vec(),
                    Order::Little => self.to_le_bytes().to_vec(),
                }
            }
        }
    )* };
}
encode!(u16 f32 f64 i32 u32 i64 u64 u8);

pub fn bytes_of<T: Encode>(numbers: &[T], order: Order) -> Vec<u8> {
    numbers.iter().flat_map(|n| n.bytes(order)).collect()
}

fn text_of<T: Encode>(numbers: &[T]) -> String {
    let words: Vec<String> = numbers.iter().map(T::to_string).collect();
    words.chunks(9).map(|line| line.join(" ")).collect::<Vec<_>>().join("\n")
}

pub fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

// Legacy VTK

#[derive(Clone, Copy, Debug)]
pub struct Legacy {
    pub binary: bool,
    pub five: bool,
    pub poly: bool,
}

pub fn legacy_vtk(sample: &Sample, how: Legacy) -> Vec<u8> {
    let n = sample.len();
    let mut out = Vec::new();
    let version = if how.five { "5.1" } else { "4.2" };
    let format = if how.binary { "BINARY" } else { "ASCII" };
    let dataset = if how.poly { "POLYDATA" } else { "UNSTRUCTURED_GRID" };
    out.extend(format!("# vtk DataFile Version {version}\na title\n{format}\nDATASET {dataset}\n").into_bytes());
    out.extend(b"FIELD FieldData 1\nradius 1 1 double\n");
    put(&mut out, &[0.025_f64], how);
    out.extend(b"METADATA\nINFORMATION 1\nNAME a LOCATION b\nDATA 2 0 1\n\n");
    out.extend(format!("POINTS {n} float\n").into_bytes());
    put(&mut out, sample.position.as_flattened(), how);
    cells(&mut out, n, how);
    out.extend(format!("CELL_DATA {n}\nSCALARS of_cell float\nLOOKUP_TABLE default\n").into_bytes());
    put(&mut out, &vec![1.0_f32; n], how);
    out.extend(format!("POINT_DATA {n}\nSCALARS id int 1\nLOOKUP_TABLE id_table\n").into_bytes());
    put(&mut out, &sample.id, how);
    out.extend(b"LOOKUP_TABLE id_table 1\n");
    if how.binary {
        out.extend([1, 2, 3, 4]);
    } else {
        out.extend(b"0 0.5 1 1\n");
    }
    out.extend(b"VECTORS velocity float\n");
    put(&mut out, sample.velocity.as_flattened(), how);
    out.extend(format!("FIELD FieldData 2\nthe%20mass 1 {n} double\n").into_bytes());
    put(&mut out, &sample.mass, how);
    out.extend(b"METADATA\nCOMPONENT_NAMES\nX\n\n");
    out.extend(format!("wide 1 {n} vtktypeint64\n").into_bytes());
    put(&mut out, &sample.id.iter().map(|&i| i64::from(i) << 20).collect::<Vec<_>>(), how);
    out
}

fn put<T: Encode>(out: &mut Vec<u8>, numbers: &[T], how: Legacy) {
    if how.binary {
        out.extend(bytes_of(numbers, Order::Big));
    } else {
        out.extend(text_of(numbers).into_bytes());
    }
    out.push(b'\n');
}

fn cells(out: &mut Vec<u8>, n: usize, how: Legacy) {
    let keyword = if how.poly { "VERTICES" } else { "CELLS" };
    if how.five {
        out.extend(format!("{keyword} {} {n}\nOFFSETS vtktypeint64\n", n + 1).into_bytes());
        put(out, &(0..=n as i64).collect::<Vec<_>>(), how);
        out.extend(b"CONNECTIVITY vtktypeint64\n");
        put(out, &(0..n as i64).collect::<Vec<_>>(), how);
    } else {
        out.extend(format!("{keyword} {n} {}\n", 2 * n).into_bytes());
        put(out, &(0..n as i32).flat_map(|i| [1, i]).collect::<Vec<_>>(), how);
    }
    if !how.poly {
        out.extend(format!("CELL_TYPES {n}\n").into_bytes());
        put(out, &vec![1_i32; n], how);
    }
}

// XML VTK

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Mode {
    Text,
    Inline,
    AppendedRaw,
    AppendedBase64,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Packing {
    None,
    Zlib,
    Lz4,
}

#[derive(Clone, Copy, Debug)]
pub struct Xml {
    pub mode: Mode,
    pub packing: Packing,
    pub wide: bool,
    pub order: Order,
    pub poly: bool,
}

pub fn xml_vtk(sample: &Sample, how: Xml) -> Vec<u8> {
    let mut writer = XmlWriter { how, xml: String::new(), appended: Vec::new() };
    let kind = if how.poly { "PolyData" } else { "UnstructuredGrid" };
    let order = if how.order == Order::Big { "BigEndian" } else { "LittleEndian" };
    let header = if how.wide { "UInt64" } else { "UInt32" };
    let compressor = match how.packing {
        Packing::None => "",
        Packing::Zlib => r#" compressor="vtkZLibDataCompressor""#,
        Packing::Lz4 => r#" compressor="vtkLZ4DataCompressor""#,
    };
    writer.xml = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"{kind}\" version=\"1.0\" byte_order=\"{order}\" header_type=\"{header}\"{compressor}>\n<{kind}>\n<FieldData>\n"
    );
    writer.array("radius", "Float64", 1, &[0.025_f64]);
    let half = sample.len() / 2;
    let _ = writeln!(writer.xml, "</FieldData>");
    for range in [0..half, half..sample.len()] {
        let n = range.len();
        let _ = writeln!(writer.xml, "<Piece NumberOfPoints=\"{n}\" NumberOfCells=\"{n}\">\n<PointData>");
        writer.array("id", "Int32", 1, &sample.id[range.clone()]);
        writer.array("velocity", "Float32", 3, sample.velocity[range.clone()].as_flattened());
        writer.array("the mass &amp; more", "Float64", 1, &sample.mass[range.clone()]);
        let _ = writeln!(writer.xml, "</PointData>\n<CellData>");
        writer.array("of_cell", "UInt8", 1, &vec![1_u8; n]);
        let _ = writeln!(writer.xml, "</CellData>\n<Points>");
        writer.array("Points", "Float32", 3, sample.position[range].as_flattened());
        let _ = writeln!(writer.xml, "</Points>\n<Cells>");
        writer.array("connectivity", "Int64", 1, &(0..n as i64).collect::<Vec<_>>());
        let _ = writeln!(writer.xml, "</Cells>\n</Piece>");
    }
    let _ = writeln!(writer.xml, "</{kind}>");
    let mut out = writer.xml.into_bytes();
    if matches!(how.mode, Mode::AppendedRaw | Mode::AppendedBase64) {
        let encoding = if how.mode == Mode::AppendedRaw { "raw" } else { "base64" };
        out.extend(format!("<AppendedData encoding=\"{encoding}\">\n  _").into_bytes());
        out.extend(writer.appended);
        out.extend(b"\n</AppendedData>\n");
    }
    out.extend(b"</VTKFile>\n");
    out
}

struct XmlWriter {
    how: Xml,
    xml: String,
    appended: Vec<u8>,
}

impl XmlWriter {
    fn array<T: Encode>(&mut self, name: &str, kind: &str, components: usize, numbers: &[T]) {
        let head = format!("<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\"");
        let _ = match self.how.mode {
            Mode::Text => writeln!(self.xml, "{head} format=\"ascii\">\n{}\n</DataArray>", text_of(numbers)),
            Mode::Inline => {
                let block = self.base64(numbers);
                // Some writers put elements into an array, before or after the text.
                let key = "<InformationKey name=\"A\" location=\"B\">1</InformationKey>";
                writeln!(self.xml, "{head} format=\"binary\">\n  {block}\n{key}</DataArray>")
            }
            Mode::AppendedRaw | Mode::AppendedBase64 => {
                let offset = self.appended.len();
                let block = match self.how.mode {
                    Mode::AppendedRaw => self.block(numbers).concat(),
                    _ => self.base64(numbers).into_bytes(),
                };
                self.appended.extend(block);
                writeln!(self.xml, "{head} format=\"appended\" offset=\"{offset}\"/>")
            }
        };
    }

    fn base64<T: Encode>(&self, numbers: &[T]) -> String {
        let [header, data] = self.block(numbers);
        if self.how.packing != Packing::None {
            // A compressed block's header is encoded by itself.
            return STANDARD.encode(header) + &STANDARD.encode(data);
        }
        STANDARD.encode([header, data].concat())
    }

    fn block<T: Encode>(&self, numbers: &[T]) -> [Vec<u8>; 2] {
        let bytes = bytes_of(numbers, self.how.order);
        let pack = match self.how.packing {
            Packing::None => return [self.word(bytes.len()), bytes],
            Packing::Zlib => zlib,
            Packing::Lz4 => lz4_flex::block::compress,
        };
        const BLOCK: usize = 64;
        let blocks: Vec<Vec<u8>> = bytes.chunks(BLOCK).map(pack).collect();
        let last = bytes.len() % BLOCK;
        let mut header = [self.word(blocks.len()), self.word(BLOCK), self.word(last)].concat();
        for block in &blocks {
            header.extend(self.word(block.len()));
        }
        [header, blocks.concat()]
    }

    fn word(&self, number: usize) -> Vec<u8> {
        let (order, number) = (self.how.order, number as u64);
        if self.how.wide { number.bytes(order) } else { (number as u32).bytes(order) }
    }
}

// PLY

/// With `None`, text. An element with a list comes before and after the vertices.
pub fn ply(sample: &Sample, order: Option<Order>) -> Vec<u8> {
    let format = match order {
        None => "ascii",
        Some(Order::Big) => "binary_big_endian",
        Some(Order::Little) => "binary_little_endian",
    };
    let mut out = format!(
        "ply\nformat {format} 1.0\ncomment of a test\nelement extra 2\nproperty list uchar int items\nproperty double x\n\
         element vertex {}\nproperty float x\nproperty float y\nproperty float z\nproperty int id\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n\
         property float vx\nproperty float vy\nproperty float vz\nproperty double mass\n\
         element face 1\nproperty list uchar int vertex_indices\nend_header\n",
        sample.len()
    )
    .into_bytes();
    let mut row = Row { out: &mut out, order };
    for length in [0_u8, 3] {
        row.put(length);
        (0..length).for_each(|i| row.put(i32::from(i)));
        row.put(0.5_f64);
        row.end();
    }
    for i in 0..sample.len() {
        sample.position[i].into_iter().for_each(|v| row.put(v));
        row.put(sample.id[i]);
        color(i).into_iter().for_each(|v| row.put(v));
        sample.velocity[i].into_iter().for_each(|v| row.put(v));
        row.put(sample.mass[i]);
        row.end();
    }
    row.put(1_u8);
    row.put(0_i32);
    row.end();
    out
}

pub fn color(i: usize) -> [u8; 4] {
    [i as u8, 255 - i as u8, 128, 255]
}

struct Row<'a> {
    out: &'a mut Vec<u8>,
    order: Option<Order>,
}

impl Row<'_> {
    fn put<T: Encode>(&mut self, number: T) {
        match self.order {
            Some(order) => self.out.extend(number.bytes(order)),
            None => self.out.extend(format!("{number} ").into_bytes()),
        }
    }

    fn end(&mut self) {
        if self.order.is_none() {
            self.out.push(b'\n');
        }
    }
}

// BGEO

fn name(out: &mut Vec<u8>, text: &str) {
    out.extend((text.len() as u16).to_be_bytes());
    out.extend(text.as_bytes());
}

/// The old generation: id, an indexed string, and velocity; a radius for the whole file.
pub fn classic_bgeo(sample: &Sample) -> Vec<u8> {
    let mut out = b"BgeoV".to_vec();
    let counts = [5, sample.len() as i32, 0, 0, 0, 3, 0, 0, 1];
    out.extend(bytes_of(&counts, Order::Big));
    name(&mut out, "id");
    out.extend([0, 1]);
    out.extend(bytes_of(&[1_i32, 0], Order::Big));
    name(&mut out, "kind");
    out.extend([0, 1]);
    out.extend(bytes_of(&[4_i32, 2], Order::Big));
    name(&mut out, "drop");
    name(&mut out, "bubble");
    name(&mut out, "velocity");
    out.extend([0, 3]);
    out.extend(bytes_of(&[5_i32, 0, 0, 0], Order::Big));
    for i in 0..sample.len() {
        out.extend(bytes_of(&sample.position[i], Order::Big));
        out.extend(bytes_of(&[1.0_f32], Order::Big));
        out.extend(bytes_of(&[sample.id[i], sample.kinds()[i]], Order::Big));
        out.extend(bytes_of(&sample.velocity[i], Order::Big));
    }
    name(&mut out, "pscale");
    out.extend([0, 1]);
    out.extend(bytes_of(&[0_i32, 0], Order::Big));
    out.extend(bytes_of(&[0.025_f32], Order::Big));
    out.extend([0, 255]);
    out
}

/// How a new BGEO stores the rows of a column.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Store {
    /// Pages of four rows.
    Pages,
    /// Pages with a pack for each component, some with one value.
    Packs,
    Tuples,
}

/// The new generation.
pub fn json_bgeo(sample: &Sample, store: Store, order: Order) -> Vec<u8> {
    let mut json = Json { out: b"\x7f".to_vec(), order };
    json.out.extend(if order == Order::Little { b"NSJb" } else { b"bJSN" });
    json.open();
    json.text("fileversion");
    json.text("18.5");
    json.text("pointcount");
    json.whole(sample.len() as i64);
    json.text("info");
    json.out.extend([0x7b]);
    json.text("bounds");
    json.uniform_f32(&[0.0; 6]);
    json.out.extend([0x7d]);
    json.text("attributes");
    json.open();
    json.text("pointattributes");
    json.open();
    json.numeric("P", 3, "fpreal32", |json| json.vectors(&sample.position, store));
    json.numeric("id", 1, "int32", |json| {
        json.text("arrays");
        json.open();
        json.uniform_i32(&sample.id);
        json.close();
    });
    json.numeric("v", 3, "fpreal32", |json| json.vectors(&sample.velocity, store));
    json.strings(&sample.kinds());
    json.close();
    json.text("globalattributes");
    json.open();
    json.numeric("particle_radius", 1, "fpreal64", |json| {
        json.text("tuples");
        json.open();
        json.open();
        json.out.push(0x1a);
        json.out.extend(0.025_f64.bytes(order));
        json.close();
        json.close();
    });
    json.close();
    json.close();
    json.text("primitives");
    json.open();
    json.close();
    json.close();
    json.out
}

struct Json {
    out: Vec<u8>,
    order: Order,
}

impl Json {
    fn open(&mut self) {
        self.out.push(0x5b);
    }

    fn close(&mut self) {
        self.out.push(0x5d);
    }

    fn length(&mut self, length: usize) {
        if length < 0xf1 {
            self.out.push(length as u8);
        } else {
            self.out.push(0xf4);
            self.out.extend((length as u32).bytes(self.order));
        }
    }

    fn text(&mut self, text: &str) {
        self.out.push(0x27);
        self.length(text.len());
        self.out.extend(text.as_bytes());
    }

    fn whole(&mut self, number: i64) {
        self.out.push(0x14);
        self.out.extend(number.bytes(self.order));
    }

    fn uniform_f32(&mut self, numbers: &[f32]) {
        self.out.extend([0x40, 0x19]);
        self.length(numbers.len());
        self.out.extend(bytes_of(numbers, self.order));
    }

    fn uniform_i32(&mut self, numbers: &[i32]) {
        self.out.extend([0x40, 0x13]);
        self.length(numbers.len());
        self.out.extend(bytes_of(numbers, self.order));
    }

    fn numeric(&mut self, name: &str, size: i64, storage: &str, data: impl FnOnce(&mut Self)) {
        self.open();
        self.open();
        // A string that is defined once and then named.
        self.text("scope");
        self.out.extend([0x2b, 7, 6]);
        self.out.extend(b"public");
        self.out.extend([0x26, 7]);
        self.text("type");
        self.text("numeric");
        self.text("name");
        self.text(name);
        self.close();
        self.open();
        self.text("defaults");
        self.open();
        self.close();
        self.text("values");
        self.open();
        self.text("size");
        self.whole(size);
        self.text("storage");
        self.text(storage);
        data(self);
        self.close();
        self.close();
        self.close();
    }

    fn vectors(&mut self, rows: &[[f32; 3]], store: Store) {
        if store == Store::Tuples {
            self.text("tuples");
            self.open();
            rows.iter().for_each(|row| self.uniform_f32(row));
            self.close();
            return;
        }
        const PAGE: usize = 4;
        self.text("pagesize");
        self.whole(PAGE as i64);
        let ends: &[usize] = if store == Store::Packs { &[0, 1, 3] } else { &[0, 3] };
        let packs: Vec<std::ops::Range<usize>> = ends.windows(2).map(|pair| pair[0]..pair[1]).collect();
        self.text("packing");
        self.out.extend([0x40, 0x21]);
        self.length(packs.len());
        packs.iter().for_each(|pack| self.out.push(pack.len() as u8));
        let is_constant = |page: &[[f32; 3]], pack: &std::ops::Range<usize>| {
            store == Store::Packs && page.iter().all(|row| bits(&row[pack.clone()]) == bits(&page[0][pack.clone()]))
        };
        self.text("constantpageflags");
        self.open();
        for pack in &packs {
            let flags: Vec<bool> = rows.chunks(PAGE).map(|page| is_constant(page, pack)).collect();
            self.out.extend([0x40, 0x10]);
            self.length(flags.len());
            for word in flags.chunks(32) {
                let word = word.iter().enumerate().fold(0_u32, |word, (bit, &flag)| word | u32::from(flag) << bit);
                self.out.extend(word.bytes(self.order));
            }
        }
        self.close();
        let mut raw = Vec::new();
        for page in rows.chunks(PAGE) {
            for pack in &packs {
                let stored = if is_constant(page, pack) { &page[..1] } else { page };
                stored.iter().for_each(|row| raw.extend(&row[pack.clone()]));
            }
        }
        self.text("rawpagedata");
        self.uniform_f32(&raw);
    }

    /// An attribute of strings, which a reader leaves out.
    fn strings(&mut self, kinds: &[i32]) {
        self.open();
        self.open();
        self.text("type");
        self.text("string");
        self.text("name");
        self.text("kind");
        self.close();
        self.open();
        self.text("strings");
        self.open();
        self.text("drop");
        self.text("bubble");
        self.close();
        self.text("indices");
        self.open();
        self.text("size");
        self.whole(1);
        self.text("storage");
        self.text("int32");
        self.text("arrays");
        self.open();
        self.uniform_i32(kinds);
        self.close();
        self.close();
        self.close();
        self.close();
    }
}

fn bits(numbers: &[f32]) -> Vec<u32> {
    numbers.iter().map(|n| n.to_bits()).collect()
}

// XYZ and CSV

pub fn xyz(sample: &Sample) -> Vec<u8> {
    bytes_of(sample.position.as_flattened(), Order::Little)
}

pub fn xyz_text(sample: &Sample) -> Vec<u8> {
    let rows = sample.position.iter().map(|[x, y, z]| format!("  {x}\t{y}, {z} # a comment\r\n"));
    format!("# x y z\n\n{}", rows.collect::<String>()).into_bytes()
}

pub fn csv(sample: &Sample) -> Vec<u8> {
    let mut out = "\u{feff}id,\"Points:0\",\"Points:1\",\"Points:2\",velocity_x,velocity_y,velocity_z,\"the \"\"mass\"\"\",name\n".to_owned();
    for i in 0..sample.len() {
        let ([x, y, z], [u, v, w]) = (sample.position[i], sample.velocity[i]);
        let _ = writeln!(out, "{},{x},{y},{z},{u},{v},{w},{:e},\"drop, {i}\"", sample.id[i], sample.mass[i]);
    }
    out.into_bytes()
}

// JSON

/// How a JSON file has its particles.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Rows {
    /// `[[x, y, z], ...]`
    Bare,
    Objects,
    Columns,
    /// Columns, a vector's numbers one after the other.
    Flat,
}

pub fn json(sample: &Sample, rows: Rows) -> Vec<u8> {
    let list = |v: &[f32]| format!("[{}]", v.iter().map(|x| format!("{x:e}")).collect::<Vec<_>>().join(", "));
    let all = |v: &[[f32; 3]]| v.iter().map(|v| list(v)).collect::<Vec<_>>().join(",\n");
    let ids = || sample.id.iter().map(i32::to_string).collect::<Vec<_>>().join(",");
    let mass = || sample.mass.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
    let text = match rows {
        Rows::Bare => format!("[{}]\n", all(&sample.position)),
        Rows::Objects => {
            let row = |i: usize| {
                let ([x, y, z], v) = (sample.position[i], list(&sample.velocity[i]));
                let (id, mass) = (sample.id[i], sample.mass[i]);
                format!(
                    r#" {{"x": {x}, "y": {y}, "z": {z}, "velocity": {v}, "id": {id}, "name": "a \"b\" {i}", "mass": {mass}}}"#
                )
            };
            format!("[\n{}\n]", (0..sample.len()).map(row).collect::<Vec<_>>().join(",\n"))
        }
        Rows::Columns => format!(
            r#"{{"version": 1, "particles": {{"position": [{}], "velocity": [{}], "id": [{}], "mass": [{}]}}, "radius": 0.025}}"#,
            all(&sample.position),
            all(&sample.velocity),
            ids(),
            mass(),
        ),
        Rows::Flat => format!(
            r#"{{"id": [{}], "velocity": {}, "mass": [{}], "position": {}, "radius": 0.025}}"#,
            ids(),
            list(sample.velocity.as_flattened()),
            mass(),
            list(sample.position.as_flattened()),
        ),
    };
    text.into_bytes()
}

// PDB and PTC

pub fn pdb(sample: &Sample, wide: bool, order: Order) -> Vec<u8> {
    let pointer = || vec![0; if wide { 8 } else { 4 }];
    let mut out = 670_u32.bytes(order);
    out.extend(1_u16.bytes(order));
    out.extend([0; 2]);
    out.extend(bytes_of(&[1.0_f32, 0.0], order));
    out.extend(bytes_of(&[sample.len() as u32, 3], order));
    out.extend([0; 32]);
    out.extend(pointer());
    let mut channel = |name: &str, kind: u32, width: u32, data: Vec<u8>| {
        out.extend([0, 0]);
        out.extend(1_u16.bytes(order));
        out.extend([0, 0]);
        out.extend(pointer());
        out.extend(bytes_of(&[kind, 0, 0, (sample.len() as u32).wrapping_sub(1)], order));
        out.extend([0; 4]);
        // What follows is aligned to the width of a pointer.
        out.extend(vec![0; if wide { 4 } else { 0 }]);
        (0..3).for_each(|_| out.extend(pointer()));
        out.extend(name.as_bytes());
        out.push(0);
        out.extend(bytes_of(&[kind, width, sample.len() as u32, 1], order));
        out.extend(pointer());
        out.extend(data);
    };
    channel("id", 3, 4, bytes_of(&sample.id, order));
    channel("position", 1, 12, bytes_of(sample.position.as_flattened(), order));
    channel("velocity", 1, 12, bytes_of(sample.velocity.as_flattened(), order));
    out
}

pub fn ptc(sample: &Sample, version: i32) -> Vec<u8> {
    let order = Order::Little;
    let mut out = b"pptc".to_vec();
    out.extend(version.bytes(order));
    out.extend((sample.len() as f64).bytes(order));
    out.extend(vec![0; 4 * (6 + [0, 4, 37][version as usize] + 35)]);
    out.extend(bytes_of(&[2_i32, 4], order));
    out.extend(b"vector velocity\nfloat mass\n");
    out.extend(vec![0; if version > 0 { 8 } else { 0 }]);
    for i in 0..sample.len() {
        out.extend(bytes_of(&sample.position[i], order));
        // A normal along x, then none.
        let angles: [u16; 2] = if i % 2 == 0 { [49151, 32768] } else { [65535; 2] };
        out.extend(bytes_of(&angles, order));
        out.extend(0.025_f32.bytes(order));
        out.extend(bytes_of(&sample.velocity[i], order));
        out.extend((sample.mass[i] as f32).bytes(order));
    }
    out
}
